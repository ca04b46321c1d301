//! Robots in rapier: bodies that drive, slip and collide, with laser, bumper, battery and odometry.
//!
//! The component [`RobotModel`] makes an entity a robot. The components [`LaserScanner`] and
//! [`WheelOdometry`] are its sensors, and [`DriveCommand`] is its input. This module needs no rendering.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_envgen::prelude::*;
//! use bevy_mapping_trial::prelude::*;
//!
//! let plugins = (EnvgenPlugins::default(), RobotPlugin::default());
//! let mut app = bevy_envgen::testing::test_app_with(plugins);
//! let command = DriveCommand { speed: 0.5, turn_rate: 0.0 };
//! let robot = app.world_mut().spawn((RobotModel::default(), command)).id();
//! bevy_envgen::testing::step(&mut app, 128);
//! let pose = app.world().get::<TruePose>(robot).unwrap();
//! assert!(pose.position.x > 0.7);
//! ```
//!
//! # Drive model
//!
//! The wheels follow the command within the speed and acceleration limits of the robot. The wheels of each
//! side run at v -/+ w b / 2 with the effective track b. The ground then pushes the body towards the motion
//! of its wheels, longitudinally and laterally, with a force of at most grip * mass * g. So a robot cannot
//! push through walls, and it slips if a wall holds it. When the body is stopped, its wheels stop too, as in
//! the flat simulator, so that odometry measures the distance that is really driven.

mod drive;
mod ground;
mod laser;
mod model;
mod scan;
mod scenarios;
mod sense;

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_envgen::EnvgenSystems;
use bevy_envgen::scenario::ScenarioSystems;
use bevy_rapier2d::prelude::PhysicsSet;

pub use laser::{LaserScan, LaserScanner};
pub use model::{
    Battery, Bumper, Chassis, DriveCommand, RobotCondition, RobotModel, TruePose, WheelOdometry,
    Wheels,
};

/// The system sets of robots, before and after those of rapier: `Drive`, [`PhysicsSet`], `Sense`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotSystems {
    /// Updates wheel speeds from commands, and pushes the bodies.
    Drive,
    /// Reads poses, bumpers, odometry, batteries and lasers.
    Sense,
}

/// Makes entities with a [`RobotModel`] drive and sense.
///
/// Rapier must run in the same schedule; see
/// [`TopDownPhysicsPlugin`](bevy_envgen::physics::TopDownPhysicsPlugin).
#[derive(Clone, Copy, Debug)]
pub struct RobotPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl RobotPlugin {
    /// Creates the plugin with its systems in `schedule` instead of `FixedUpdate`. It must be rapier's
    /// schedule.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        RobotPlugin { schedule: schedule.intern() }
    }
}

impl Default for RobotPlugin {
    fn default() -> Self {
        RobotPlugin::new(FixedUpdate)
    }
}

impl Plugin for RobotPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Battery>()
            .register_type::<Bumper>()
            .register_type::<Chassis>()
            .register_type::<DriveCommand>()
            .register_type::<LaserScan>()
            .register_type::<LaserScanner>()
            .register_type::<RobotCondition>()
            .register_type::<RobotModel>()
            .register_type::<TruePose>()
            .register_type::<WheelOdometry>()
            .register_type::<Wheels>()
            .add_observer(model::fit)
            .add_observer(model::unfit)
            .configure_sets(
                self.schedule,
                (
                    RobotSystems::Drive
                        .after(EnvgenSystems::Notify)
                        .before(PhysicsSet::SyncBackend),
                    RobotSystems::Sense.after(PhysicsSet::Writeback).after(ScenarioSystems),
                ),
            )
            .add_systems(
                self.schedule,
                (
                    (model::weigh, (ground::index, drive::drive).chain())
                        .in_set(RobotSystems::Drive),
                    sense::note_places
                        .after(PhysicsSet::SyncBackend)
                        .before(PhysicsSet::StepSimulation),
                    (sense::sense, scan::scan).chain().in_set(RobotSystems::Sense),
                ),
            );
        model::fit_early(app.world_mut());
    }
}
