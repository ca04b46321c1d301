//! Pictures of the cameras of a running app.

use std::path::PathBuf;
use std::sync::Arc;

use bevy::camera::{NormalizedRenderTarget, RenderTarget};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Capturing, Screenshot, ScreenshotCaptured};
use bevy::window::PrimaryWindow;

use crate::captured_image::CapturedImage;
use crate::error::{CaptureError, MOST_FRAMES};

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
        app.add_observer(take).add_observer(fail).add_systems(Last, give_up);
    }
}

/// The requests that a screenshot of Bevy answers: it takes one of a target at a time.
#[derive(Component)]
struct Asked {
    target: NormalizedRenderTarget,
    requests: Vec<Request>,
    /// Frames since the first of them.
    frames: u32,
}

struct Request {
    camera: Entity,
    path: PathBuf,
    side: u32,
}

fn take(
    request: On<TakePicture>,
    cameras: Query<(&RenderTarget, Option<&Supersampling>), With<Camera>>,
    windows: Query<Entity, With<PrimaryWindow>>,
    mut commands: Commands,
) {
    let TakePicture { entity: camera, path } = request.event().clone();
    let found = cameras.get(camera).ok().and_then(|(target, samples)| {
        let normalized = target.normalize(windows.iter().next())?;
        let is_drawn = !matches!(normalized, NormalizedRenderTarget::None { .. });
        is_drawn.then(|| (target.clone(), normalized, samples.map_or(1, |samples| samples.0)))
    });
    let Some((target, normalized, side)) = found else {
        let error = Arc::new(CaptureError::NoCamera { camera });
        commands.trigger(PictureFailed { entity: camera, error });
        return;
    };
    let request = Request { camera, path, side };
    commands.queue(move |world: &mut World| {
        let mut waiting = world.query_filtered::<&mut Asked, Without<Capturing>>();
        if let Some(mut asked) = waiting.iter_mut(world).find(|asked| asked.target == normalized) {
            asked.requests.push(request);
        } else {
            let asked = Asked { target: normalized, requests: vec![request], frames: 0 };
            world.spawn((Screenshot(target), asked)).observe(answer);
        }
    });
}

/// Writes a picture for all that asked for it.
fn answer(captured: On<ScreenshotCaptured>, mut all: Query<&mut Asked>, mut commands: Commands) {
    let Ok(mut asked) = all.get_mut(captured.entity) else { return };
    for Request { camera, path, side } in std::mem::take(&mut asked.requests) {
        let picture = CapturedImage::averaged(&captured.image, side);
        match picture.and_then(|picture| picture.write_png(&path)) {
            Ok(()) => commands.trigger(PictureTaken { entity: camera, path }),
            Err(error) => {
                commands.trigger(PictureFailed { entity: camera, error: Arc::new(error) })
            }
        }
    }
}

/// Gives up screenshots that do not arrive, such as those of an image that is gone.
fn give_up(mut all: Query<(Entity, &mut Asked)>, mut commands: Commands) {
    for (entity, mut asked) in &mut all {
        asked.frames += 1;
        if asked.frames > MOST_FRAMES {
            commands.entity(entity).try_despawn();
        }
    }
}

/// Tells those that still wait for a screenshot that it is gone.
fn fail(gone: On<Remove, Asked>, mut all: Query<&mut Asked>, mut commands: Commands) {
    let Ok(mut asked) = all.get_mut(gone.entity) else { return };
    for Request { camera, .. } in std::mem::take(&mut asked.requests) {
        let error = Arc::new(CaptureError::Lost { frames: MOST_FRAMES });
        commands.trigger(PictureFailed { entity: camera, error });
    }
}
