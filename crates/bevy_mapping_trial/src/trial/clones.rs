//! Removes robots that exist without their trial.

use bevy::prelude::*;
use bevy_envgen::Environment;

use super::component::{MappingTrial, TrialRobot};

/// A filter for the parents of robots, also where an observer of a robot removed the environment.
type Parent = Or<(With<Environment>, With<MappingTrial>)>;

/// Despawns the robots below an environment that were spawned from a scene or cloned, since scenes and clones
/// do not hold the trial of these robots.
pub(super) fn dismiss(
    added: Query<(Entity, &ChildOf), Added<TrialRobot>>,
    parents: Query<Option<&MappingTrial>, Parent>,
    mut commands: Commands,
) {
    for (robot, below) in &added {
        let Ok(trial) = parents.get(below.parent()) else { continue };
        if !trial.is_some_and(|trial| trial.robots().contains(&robot)) {
            commands.entity(robot).try_despawn();
        }
    }
}
