//! Robots in rapier: bodies that drive, slip and collide, with laser, bumper, battery and odometry.
//!
//! [`RobotModel`] makes an entity a robot; [`LaserScanner`] and [`WheelOdometry`] are its sensors,
//! [`DriveCommand`] is its input. Nothing here needs rendering.
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
//! The wheels follow the command within the robot's limits of speed and acceleration. Each side
//! runs at v -/+ w b / 2 with the effective track b. The ground then pushes the body towards the
//! motion of its wheels, longitudinally and laterally, with a force of at most grip * mass * g. So
//! a robot cannot push through walls, and slips where a wall holds it. When the body is stopped,
//! its wheels stop too, as in the flat simulator, so that odometry measures the distance really
//! travelled.

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
use bevy_envgen::scenario::ScenarioSystems;
use bevy_rapier2d::prelude::PhysicsSet;

pub use laser::{LaserScan, LaserScanner};
pub use model::{
    Battery, Bumper, Chassis, DriveCommand, RobotCondition, RobotModel, TruePose, WheelOdometry,
    Wheels,
};

/// The systems of robots, before and after rapier's: `Drive`, [`PhysicsSet`], `Sense`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotSystems {
    /// Updates wheel speeds from commands, and pushes the bodies.
    Drive,
    /// Reads poses, bumpers, odometry, batteries and lasers.
    Sense,
}

/// Lets entities with a [`RobotModel`] drive and sense.
///
/// Rapier must run in the same schedule: see
/// [`TopDownPhysicsPlugin`](bevy_envgen::physics::TopDownPhysicsPlugin).
#[derive(Clone, Copy, Debug)]
pub struct RobotPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl RobotPlugin {
    /// Runs the systems in `schedule` instead of `FixedUpdate`; it must be rapier's schedule.
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
            .configure_sets(
                self.schedule,
                (
                    RobotSystems::Drive.before(PhysicsSet::SyncBackend),
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
    }
}
