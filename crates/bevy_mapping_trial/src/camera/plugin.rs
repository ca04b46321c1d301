//! The plugin of cameras, and the schedule in which they take pictures.

use bevy::app::PostUpdate;
use bevy::camera::CameraUpdateSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::light::SimulationLightSystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use bevy_offscreen::DrawnFramesPlugin;

use super::settings::RobotCamera;
use super::shutter::{self, RobotCameraView};

/// Takes pictures with the cameras of robots that have a [`RobotCamera`]. Pictures that lack something because Bevy is
/// still compiling pipelines are dropped, and taken again.
#[derive(Clone, Copy, Debug, Default)]
pub struct RobotCameraPlugin;

/// The system set that takes pictures, in [`PostUpdate`], after transforms and cameras are updated.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RobotCameraSystems;

impl Plugin for RobotCameraPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<DrawnFramesPlugin>() {
            app.add_plugins(DrawnFramesPlugin);
        }
        app.register_type::<RobotCamera>()
            .register_type::<RobotCameraView>()
            .register_type::<shutter::Eye>()
            .init_resource::<shutter::Scenes>()
            .add_observer(shutter::remove)
            .add_observer(shutter::fit)
            .add_observer(shutter::develop)
            .add_systems(First, (shutter::close, shutter::remove_clones))
            .add_systems(
                PostUpdate,
                shutter::shoot
                    .in_set(RobotCameraSystems)
                    .after(TransformSystems::Propagate)
                    .after(CameraUpdateSystems)
                    // These systems skip cameras that are inactive, which drawing does not expect.
                    .before(SimulationLightSystems::UpdateDirectionalLightCascades)
                    .before(VisibilitySystems::UpdateFrusta)
                    .before(VisibilitySystems::CheckVisibility),
            );
    }
}
