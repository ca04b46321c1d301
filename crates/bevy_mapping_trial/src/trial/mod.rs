//! Mapping trials in rapier: the autonomy, protocol, log and scores of [`mapping_trial`], with the
//! robots of [`crate::robot`] as robot backend.
//!
//! Put a [`MappingTrial`] on the entity of an [`Environment`](bevy_envgen::Environment): once the world
//! is ready, its robots are spawned as children of the environment, and the trial runs at 20 ticks
//! per simulated second. [`run_headless`] runs a trial without an app.
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
//! [`TrialSystems::Command`], [`RobotSystems::Drive`](crate::robot::RobotSystems), rapier's
//! `PhysicsSet`, [`ScenarioSystems`](bevy_envgen::ScenarioSystems), [`RobotSystems::Sense`](crate::robot::RobotSystems), [`TrialSystems::Record`]. The
//! schedule's step must be [`TICK`](mapping_trial::backend::TICK), and rapier's with it:
//! [`TopDownPhysicsPlugin::for_trials`](ForTrials::for_trials) sets both.
//! In the first tick after the robots were spawned only observations are made: rapier must create
//! their bodies before the first scan.
//!
//! # Replay
//!
//! A log of engine [`ENGINE`] replays to the last bit with the same build of the program, on the
//! same kind of machine, in an environment with the same transform, origin and colliders; rapier's floating-point
//! results differ between platforms. [`replay_headless`] has those of [`run_headless`]:
//! [`ColliderSettings::for_trials`](ForTrials::for_trials), and no transform.
//!
//! # Scenarios
//!
//! A trial meets the doors, people and smoke of the [`EnvironmentScenario`](bevy_envgen::EnvironmentScenario) of its
//! environment, from their start on: the same as in the flat simulator. The log holds them and the commands of an
//! app to their doors, and a replay gives its environment those of the log alone. Everything else that an app adds to
//! the world is not in the log. Another scenario in the environment lets the trial begin again, as another world does.

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
