//! The plugin of trials, and the order of its systems.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_envgen::EnvgenSystems;
use bevy_rapier2d::prelude::PhysicsSet;

use super::component::{ManualControl, MappingTrial, TrialRobot};
use super::{clones, colliders, run, scenario};
use crate::robot::{RobotPlugin, RobotSystems};

/// The system sets of trials, before and after those of robots.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrialSystems {
    /// Begins and ends trials, processes what the robots have sensed, and commands them.
    Command,
    /// Records the new poses and measurements of the robots.
    Record,
}

/// Runs the trials of [`MappingTrial`] components. Adds [`RobotPlugin`] to the same schedule, unless it is
/// already added.
#[derive(Clone, Copy, Debug)]
pub struct TrialPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl TrialPlugin {
    /// Creates the plugin with its systems in `schedule` instead of `FixedUpdate`. It must be rapier's
    /// schedule, and time must advance by a tick whenever it runs.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        TrialPlugin { schedule: schedule.intern() }
    }
}

impl Default for TrialPlugin {
    fn default() -> Self {
        TrialPlugin::new(FixedUpdate)
    }
}

impl Plugin for TrialPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<RobotPlugin>() {
            app.add_plugins(RobotPlugin::new(self.schedule));
        }
        app.register_type::<ManualControl>()
            .register_type::<MappingTrial>()
            .register_type::<TrialRobot>()
            .add_observer(run::leave)
            .add_observer(colliders::give_back)
            .add_observer(colliders::notice_removal)
            .add_observer(colliders::give_to_clones)
            .add_observer(run::lose_world)
            .add_observer(scenario::give_back)
            .add_observer(scenario::give_to_clones)
            .configure_sets(
                self.schedule,
                (
                    TrialSystems::Command.after(EnvgenSystems::Notify).before(RobotSystems::Drive),
                    TrialSystems::Record.after(RobotSystems::Sense).after(PhysicsSet::Writeback),
                ),
            )
            .add_systems(
                self.schedule,
                (
                    (
                        clones::dismiss,
                        run::refuse_places,
                        run::begin,
                        colliders::replace,
                        run::command,
                    )
                        .chain()
                        .in_set(TrialSystems::Command),
                    run::record.in_set(TrialSystems::Record),
                ),
            );
    }
}
