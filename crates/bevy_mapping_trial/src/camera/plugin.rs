//! The plugin of cameras, and when pictures are taken.

use bevy::app::PostUpdate;
use bevy::camera::CameraUpdateSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::light::SimulationLightSystems;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

use super::settings::RobotCamera;
use super::shutter::{self, RobotCameraView};

/// Lets robots with a [`RobotCamera`] see.
#[derive(Clone, Copy, Debug, Default)]
pub struct RobotCameraPlugin;

/// When pictures are taken, in [`PostUpdate`], after transforms and cameras are updated.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RobotCameraSystems;

impl Plugin for RobotCameraPlugin {
    fn build(&self, app: &mut App) {
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
                    // They leave cameras out that are not active, which drawing does not expect.
                    .before(SimulationLightSystems::UpdateDirectionalLightCascades)
                    .before(VisibilitySystems::UpdateFrusta)
                    .before(VisibilitySystems::CheckVisibility),
            );
    }
}
