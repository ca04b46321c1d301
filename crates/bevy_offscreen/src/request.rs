//! Pictures of the cameras of a running app.

use std::path::PathBuf;
use std::sync::Arc;

use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};

use crate::captured_image::CapturedImage;
use crate::error::CaptureError;

/// Requests a picture of what a camera draws into, an image or a window, as PNG. A few frames later
/// [`PictureTaken`] or [`PictureFailed`] is triggered on the camera.
#[derive(EntityEvent, Clone, Debug)]
pub struct TakePicture {
    /// The camera.
    pub entity: Entity,
    /// The file to write.
    pub path: PathBuf,
}

/// Triggered on a camera when its picture was written.
#[derive(EntityEvent, Clone, Debug)]
pub struct PictureTaken {
    /// The camera.
    pub entity: Entity,
    /// The file.
    pub path: PathBuf,
}

/// Triggered on a camera when its picture could not be taken or written.
#[derive(EntityEvent, Clone, Debug)]
pub struct PictureFailed {
    /// The entity of the request.
    pub entity: Entity,
    /// Why.
    pub error: Arc<CaptureError>,
}

/// How many pixels of a camera's image, from left to right and from top to bottom, make one of its pictures; 1 for a
/// camera without it.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct Supersampling(pub(crate) u32);

/// Takes pictures of cameras when [`TakePicture`] is triggered. Needs Bevy's `RenderPlugin`;
/// without it, requests are not answered.
#[derive(Clone, Copy, Debug, Default)]
pub struct CapturePlugin;

impl Plugin for CapturePlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(take);
    }
}

fn take(
    request: On<TakePicture>,
    cameras: Query<(&RenderTarget, Option<&Supersampling>), With<Camera>>,
    mut commands: Commands,
) {
    let TakePicture { entity: camera, path } = request.event().clone();
    let Ok((target, samples)) = cameras.get(camera) else {
        let error = Arc::new(CaptureError::NoCamera { camera });
        commands.trigger(PictureFailed { entity: camera, error });
        return;
    };
    let side = samples.map_or(1, |samples| samples.0);
    commands.spawn(Screenshot(target.clone())).observe(
        move |captured: On<ScreenshotCaptured>, mut commands: Commands| {
            let path = path.clone();
            let picture = CapturedImage::averaged(&captured.image, side);
            let written = picture.and_then(|picture| picture.write_png(&path));
            match written {
                Ok(()) => commands.trigger(PictureTaken { entity: camera, path }),
                Err(error) => {
                    commands.trigger(PictureFailed { entity: camera, error: Arc::new(error) })
                }
            }
        },
    );
}
