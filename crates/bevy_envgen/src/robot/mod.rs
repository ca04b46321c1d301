//! Robots in rapier: a body that drives, bumps, slips, sees and counts the turns of its wheels.
//!
//! [`RobotModel`] makes an entity a robot; [`LaserScanner`] and [`WheelOdometry`] are its sensors,
//! [`DriveCommand`] is what it is told. Nothing here needs rendering.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_envgen::prelude::*;
//! use bevy_envgen::robot::{DriveCommand, RobotModel, RobotPlugin, TruePose};
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
//! # The model of the drive
//!
//! The wheels follow the command within the robot's limits of speed and acceleration, each side at
//! v -/+ w b / 2 with the effective track b. The ground then pushes the body towards the motion of
//! its wheels, ahead and sideways, with at most grip * mass * g: so a robot does not push through
//! walls, slips where the wall holds it, and is stopped sideways. What stops the body stops its
//! wheels, as in the flat simulator, so that odometry measures the way that was really made.

mod drive;
mod ground;
mod laser;
mod model;
mod sense;

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier2d::prelude::PhysicsSet;

pub use laser::{LaserScan, LaserScanner};
pub use model::{
    Battery, Bumper, Chassis, DriveCommand, RobotCondition, RobotModel, TruePose, WheelOdometry,
    Wheels,
};

use crate::physics::DoorSystems;

/// The systems of robots, around those of rapier: `Drive`, [`PhysicsSet`], `Sense`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotSystems {
    /// Wheels follow their commands, and the ground pushes the bodies.
    Drive,
    /// Poses, bumpers, odometry, batteries and lasers are read.
    Sense,
}

/// Lets entities with a [`RobotModel`] drive and sense.
///
/// Rapier must run in the same schedule: see
/// [`TopDownPhysicsPlugin`](crate::physics::TopDownPhysicsPlugin).
#[derive(Clone, Copy, Debug)]
pub struct RobotPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl RobotPlugin {
    /// With the systems in another schedule than `FixedUpdate`: rapier's.
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
                    RobotSystems::Drive.before(PhysicsSet::SyncBackend).after(DoorSystems),
                    RobotSystems::Sense.after(PhysicsSet::Writeback),
                ),
            )
            .add_systems(
                self.schedule,
                (
                    (ground::index, drive::drive).chain().in_set(RobotSystems::Drive),
                    (sense::sense, laser::scan).chain().in_set(RobotSystems::Sense),
                ),
            );
    }
}
