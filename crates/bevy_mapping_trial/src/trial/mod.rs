//! Mapping trials in rapier: the autonomy, protocol, log and scores of [`mapping_trial`], with the robots of
//! [`crate::robot`] as the robot backend.
//!
//! Add a [`MappingTrial`] to the entity of an [`Environment`](bevy_envgen::Environment). Once the world is
//! ready, its robots are spawned as children of the environment, and the trial runs at 20 ticks per simulated
//! second. The function [`run_headless`] runs a trial without an app.
//!
//! ```
//! use bevy_mapping_trial::trial::run_headless;
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//! use mapping_trial::trial::TrialSettings;
//!
//! let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
//! let settings = TrialSettings { time_limit: 30.0, ..Default::default() };
//! let trial = run_headless(&world, settings, |_| ())?;
//! assert!(trial.trajectory(0).distance > 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A tick
//!
//! The systems of a tick run in this order: [`TrialSystems::Command`],
//! [`RobotSystems::Drive`](crate::robot::RobotSystems), rapier's `PhysicsSet`,
//! [`ScenarioSystems`](bevy_envgen::ScenarioSystems), [`RobotSystems::Sense`](crate::robot::RobotSystems),
//! [`TrialSystems::Record`]. The steps of the schedule and of rapier must both be
//! [`TICK`](mapping_trial::backend::TICK): [`TopDownPhysicsPlugin::for_trials`](ForTrials::for_trials) sets
//! both. The first tick after the robots are spawned only makes observations, since rapier must create their
//! bodies before the first scan.
//!
//! # Replay
//!
//! A log of engine [`ENGINE`] replays to the last bit with the same build of the program, on the same kind of
//! machine, in an environment with the same transform, origin and colliders. Rapier's floating-point results
//! differ between platforms. [`replay_headless`] uses those of [`run_headless`]: no transform, and the
//! colliders of [`ColliderSettings::for_trials`](ForTrials::for_trials).
//!
//! # Scenarios
//!
//! A trial includes the doors, people and smoke of the
//! [`EnvironmentScenario`](bevy_envgen::EnvironmentScenario) of its environment from their beginning, the
//! same as in the flat simulator. The log contains them and the commands of an app to the doors, and a replay
//! uses only those of the log, until it is removed. Everything else that an app adds to the world is not in
//! the log. Like another world, another scenario in the environment makes the trial begin again.

mod bodies;
mod camera;
mod clones;
mod colliders;
mod component;
mod error;
mod event;
mod headless;
mod physics;
mod plugin;
mod run;
mod scenario;

pub use bodies::{ENGINE, RapierRobots};
pub use component::{ManualControl, MappingTrial, TrialRobot};
pub use error::MappingTrialError;
pub use event::{TrialEnded, TrialFailed, TrialStarted};
pub use headless::{
    HeadlessError, replay_headless, replay_headless_with, run_headless, run_headless_with,
};
#[cfg(feature = "camera")]
pub(crate) use headless::{drive, set_up};
pub use physics::ForTrials;
pub use plugin::{TrialPlugin, TrialSystems};
#[cfg(feature = "camera")]
pub(crate) use run::in_world;
