//! Robots that came without their trial.

use bevy::prelude::*;
use bevy_envgen::Environment;

use super::component::{MappingTrial, TrialRobot};

/// Despawns the robots that came out of a scene, or as clones, below an environment: scenes and clones do not hold
/// their trial.
pub(super) fn dismiss(
    added: Query<(Entity, &ChildOf), Added<TrialRobot>>,
    environments: Query<Option<&MappingTrial>, With<Environment>>,
    mut commands: Commands,
) {
    for (robot, below) in &added {
        let Ok(trial) = environments.get(below.parent()) else { continue };
        if !trial.is_some_and(|trial| trial.robots().contains(&robot)) {
            commands.entity(robot).try_despawn();
        }
    }
}
