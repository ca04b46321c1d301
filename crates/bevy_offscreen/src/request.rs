//! Requests for pictures of the cameras of a running app.

use std::path::PathBuf;
use std::sync::Arc;

use bevy::camera::{NormalizedRenderTarget, RenderTarget};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Capturing, Screenshot, ScreenshotCaptured};
use bevy::window::PrimaryWindow;

use crate::captured_image::CapturedImage;
use crate::drawn_frames::{DrawnFrames, DrawnFramesPlugin};
use crate::error::{CaptureError, MOST_FRAMES};

/// An event that requests a picture of what a camera draws into an image or a window, as a PNG file.
///
/// A few frames later [`PictureTaken`] or [`PictureFailed`] is triggered on the camera. A camera that is not
/// active draws until then. While Bevy compiles pipelines, the picture waits, so that it lacks nothing.
///
/// Bevy takes one screenshot of a target per frame. An app that spawns a [`Screenshot`] of the same target in the same
/// frame loses one of the two.
#[derive(EntityEvent, Clone, Debug)]
pub struct TakePicture {
    /// The entity of the camera.
    pub entity: Entity,
    /// The path of the file to write.
    pub path: PathBuf,
}

/// An event that is triggered on a camera when its picture has been written.
#[derive(EntityEvent, Clone, Debug)]
pub struct PictureTaken {
    /// The entity of the camera.
    pub entity: Entity,
    /// The path of the file.
    pub path: PathBuf,
}

/// An event that is triggered on a camera when its picture could not be taken or written.
#[derive(EntityEvent, Clone, Debug)]
pub struct PictureFailed {
    /// The entity of the request, which may have no camera.
    pub entity: Entity,
    /// The reason of the failure.
    pub error: Arc<CaptureError>,
}

/// A component with the number of pixels of a camera's image, along each side, that are averaged into one
/// pixel of a picture. It is 1 for a camera without this component.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct Supersampling(pub(crate) u32);

/// Takes pictures of cameras when [`TakePicture`] is triggered.
///
/// Needs Bevy's `RenderPlugin`. Without it, requests fail after 100 frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct CapturePlugin;

impl Plugin for CapturePlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<DrawnFramesPlugin>() {
            app.add_plugins(DrawnFramesPlugin);
        }
        app.add_observer(take)
            .add_observer(fail)
            .add_systems(Last, (capture_woken, give_up).chain());
    }
}

/// The requests that one screenshot of Bevy answers, since Bevy takes one screenshot of a target at a time.
/// The entity has no [`Screenshot`] until a camera that was not active has drawn.
#[derive(Component)]
struct Asked {
    source: RenderTarget,
    target: NormalizedRenderTarget,
    requests: Vec<Request>,
    /// The number of frames since the first request, or since the last screenshot.
    frames: u32,
    /// The frame in which the screenshot was requested of Bevy.
    shot: u64,
    /// The number of screenshots that were not complete.
    incomplete: u32,
}

struct Request {
    camera: Entity,
    path: PathBuf,
    side: u32,
    /// Whether the camera is active only for this request.
    wakes: bool,
}

fn take(
    request: On<TakePicture>,
    mut cameras: Query<(&mut Camera, &RenderTarget, Option<&Supersampling>)>,
    windows: Query<Entity, With<PrimaryWindow>>,
    drawn: Res<DrawnFrames>,
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
    let shot = drawn.current();
    commands.queue(move |world: &mut World| {
        let mut waiting =
            world.query_filtered::<(&mut Asked, Has<Screenshot>), Without<Capturing>>();
        // A camera that was not active before is not drawn in this frame.
        let wakes = request.wakes;
        let suits = |asked: &Asked, is_due: bool| asked.target == target && !(wakes && is_due);
        let found = waiting.iter_mut(world).find(|(asked, is_due)| suits(asked, *is_due));
        if let Some((mut asked, _)) = found {
            asked.requests.push(request);
            if wakes {
                // The screenshot waits for this camera too.
                asked.frames = 0;
            }
            return;
        }
        let (source, requests) = (source.clone(), vec![request]);
        let asked = Asked { source, target, requests, frames: 0, shot, incomplete: 0 };
        let screenshot = Screenshot(asked.source.clone());
        let mut picture = world.spawn(asked);
        picture.observe(answer);
        if !wakes {
            picture.insert(screenshot);
        }
    });
}

/// Filters for requests that are not passed on to Bevy yet.
type Unasked = (Without<Screenshot>, Without<Capturing>);

/// Requests screenshots of the cameras that have been active for a whole frame, one of each target.
fn capture_woken(
    mut waiting: Query<(Entity, &mut Asked), Unasked>,
    due: Query<&Asked, (With<Screenshot>, Without<Capturing>)>,
    drawn: Res<DrawnFrames>,
    mut commands: Commands,
) {
    let mut targets: Vec<_> = due.iter().map(|asked| asked.target.clone()).collect();
    for (entity, mut asked) in &mut waiting {
        if asked.frames > 0 && !asked.requests.is_empty() && !targets.contains(&asked.target) {
            asked.shot = drawn.current();
            targets.push(asked.target.clone());
            commands.entity(entity).insert(Screenshot(asked.source.clone()));
        }
    }
}

/// Deactivates a camera that was active only for a request.
fn rest(request: &Request, cameras: &mut Query<&mut Camera>) {
    if request.wakes
        && let Ok(mut camera) = cameras.get_mut(request.camera)
    {
        camera.is_active = false;
    }
}

/// Writes the picture to the file of each request for it, or requests another one if it may lack something.
fn answer(
    captured: On<ScreenshotCaptured>,
    mut all: Query<&mut Asked>,
    mut cameras: Query<&mut Camera>,
    drawn: Res<DrawnFrames>,
    mut commands: Commands,
) {
    let Ok(mut asked) = all.get_mut(captured.entity) else { return };
    let requests = std::mem::take(&mut asked.requests);
    if !drawn.is_complete(asked.shot) && asked.incomplete < MOST_FRAMES {
        let (source, target) = (asked.source.clone(), asked.target.clone());
        let incomplete = asked.incomplete + 1;
        let again = Asked { source, target, requests, frames: 1, shot: asked.shot, incomplete };
        commands.spawn(again).observe(answer);
        return;
    }
    for request in requests {
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

/// Gives up on screenshots that do not arrive, such as those of an image that no longer exists.
fn give_up(mut all: Query<(Entity, &mut Asked)>, mut commands: Commands) {
    for (entity, mut asked) in &mut all {
        asked.frames += 1;
        if asked.frames > MOST_FRAMES {
            commands.entity(entity).try_despawn();
        }
    }
}

/// Reports to the cameras of the waiting requests that the screenshot has failed.
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
