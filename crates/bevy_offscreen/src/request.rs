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
/// [`PictureTaken`] or [`PictureFailed`] is triggered on the camera. Until then a camera that is not active draws.
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
        app.add_observer(take)
            .add_observer(fail)
            .add_systems(Last, (capture_woken, give_up).chain());
    }
}

/// The requests that a screenshot of Bevy answers: it takes one of a target at a time. Without a [`Screenshot`] until a
/// camera that was not active has drawn.
#[derive(Component)]
struct Asked {
    source: RenderTarget,
    target: NormalizedRenderTarget,
    requests: Vec<Request>,
    /// Frames since the first of them.
    frames: u32,
}

struct Request {
    camera: Entity,
    path: PathBuf,
    side: u32,
    /// Whether the camera is active for it alone.
    wakes: bool,
}

fn take(
    request: On<TakePicture>,
    mut cameras: Query<(&mut Camera, &RenderTarget, Option<&Supersampling>)>,
    windows: Query<Entity, With<PrimaryWindow>>,
    mut commands: Commands,
) {
    let TakePicture { entity: camera, path } = request.event().clone();
    let found = cameras.get_mut(camera).ok().and_then(|(mut drawing, source, samples)| {
        let target = source.normalize(windows.iter().next())?;
        if matches!(target, NormalizedRenderTarget::None { .. }) {
            return None;
        }
        let wakes = !drawing.is_active;
        if wakes {
            drawing.is_active = true;
        }
        let side = samples.map_or(1, |samples| samples.0);
        Some((source.clone(), target, Request { camera, path, side, wakes }))
    });
    let Some((source, target, request)) = found else {
        let error = Arc::new(CaptureError::NoCamera { camera });
        commands.trigger(PictureFailed { entity: camera, error });
        return;
    };
    commands.queue(move |world: &mut World| {
        let mut waiting =
            world.query_filtered::<(&mut Asked, Has<Screenshot>), Without<Capturing>>();
        // What was not active is not drawn in this frame.
        let wakes = request.wakes;
        let suits = |asked: &Asked, is_due: bool| asked.target == target && !(wakes && is_due);
        let found = waiting.iter_mut(world).find(|(asked, is_due)| suits(asked, *is_due));
        if let Some((mut asked, _)) = found {
            asked.requests.push(request);
            return;
        }
        let asked = Asked { source: source.clone(), target, requests: vec![request], frames: 0 };
        let mut picture = world.spawn(asked);
        picture.observe(answer);
        if !wakes {
            picture.insert(Screenshot(source));
        }
    });
}

/// What is not asked of Bevy yet.
type Unasked = (Without<Screenshot>, Without<Capturing>);

/// Asks for the pictures of cameras that have been active for a whole frame.
fn capture_woken(waiting: Query<(Entity, &Asked), Unasked>, mut commands: Commands) {
    for (entity, asked) in &waiting {
        if asked.frames > 0 && !asked.requests.is_empty() {
            commands.entity(entity).insert(Screenshot(asked.source.clone()));
        }
    }
}

/// Lets a camera rest again that was active for a request alone.
fn rest(request: &Request, cameras: &mut Query<&mut Camera>) {
    if request.wakes
        && let Ok(mut camera) = cameras.get_mut(request.camera)
    {
        camera.is_active = false;
    }
}

/// Writes a picture for all that asked for it.
fn answer(
    captured: On<ScreenshotCaptured>,
    mut all: Query<&mut Asked>,
    mut cameras: Query<&mut Camera>,
    mut commands: Commands,
) {
    let Ok(mut asked) = all.get_mut(captured.entity) else { return };
    for request in std::mem::take(&mut asked.requests) {
        rest(&request, &mut cameras);
        let Request { camera, path, side, .. } = request;
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
fn fail(
    gone: On<Remove, Asked>,
    mut all: Query<&mut Asked>,
    mut cameras: Query<&mut Camera>,
    mut commands: Commands,
) {
    let Ok(mut asked) = all.get_mut(gone.entity) else { return };
    for request in std::mem::take(&mut asked.requests) {
        rest(&request, &mut cameras);
        let camera = request.camera;
        let error = Arc::new(CaptureError::Lost { frames: MOST_FRAMES });
        commands.trigger(PictureFailed { entity: camera, error });
    }
}
