//! The frames in which nothing was left out because of a pipeline that was not compiled yet.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bevy::prelude::*;
use bevy::render::render_resource::{CachedPipelineState, PipelineCache};
use bevy::render::{Extract, ExtractSchedule, Render, RenderApp, RenderSystems};

/// A resource that says which frames Bevy has drawn completely. In apps with a window Bevy compiles pipelines in the
/// background, and leaves out what needs one that is not ready.
#[derive(Resource, Clone, Debug, Default)]
pub struct DrawnFrames {
    /// The number of the current frame, counted from 1.
    frame: u64,
    /// The number of the last frame that was drawn without some pipeline, or 0.
    incomplete: Arc<AtomicU64>,
}

impl DrawnFrames {
    /// Returns the number of the current frame.
    pub fn current(&self) -> u64 {
        self.frame
    }

    /// Returns whether all pipelines were ready in a frame that has been drawn, and in all that have been drawn after it.
    pub fn is_complete(&self, frame: u64) -> bool {
        self.incomplete.load(Ordering::Acquire) < frame
    }
}

/// Adds [`DrawnFrames`]. Without Bevy's `RenderPlugin` all frames count as complete.
#[derive(Clone, Copy, Debug, Default)]
pub struct DrawnFramesPlugin;

impl Plugin for DrawnFramesPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<DrawnFrames>().add_systems(First, count);
    }

    fn finish(&self, app: &mut App) {
        let frames = app.world().get_resource::<DrawnFrames>().cloned().unwrap_or_default();
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            render_app
                .insert_resource(frames)
                .add_systems(ExtractSchedule, extract)
                .add_systems(Render, watch.in_set(RenderSystems::Cleanup));
        }
    }
}

fn count(mut frames: ResMut<DrawnFrames>) {
    frames.frame += 1;
}

fn extract(main: Extract<Res<DrawnFrames>>, mut frames: ResMut<DrawnFrames>) {
    frames.frame = main.frame;
}

/// Records whether the frame that is being drawn lacks a pipeline. Bevy counts a pipeline as waiting for one more frame
/// after it is ready.
fn watch(cache: Option<Res<PipelineCache>>, frames: Res<DrawnFrames>) {
    let Some(cache) = cache else { return };
    let is_missing = |pipeline: usize| {
        let pipeline = cache.pipelines().nth(pipeline);
        pipeline.is_some_and(|pipeline| !matches!(pipeline.state, CachedPipelineState::Ok(_)))
    };
    if cache.waiting_pipelines().any(is_missing) {
        frames.incomplete.store(frames.frame, Ordering::Release);
    }
}
