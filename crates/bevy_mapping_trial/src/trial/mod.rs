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
//! same kind of machine; rapier's floating-point results differ between platforms.
//!
//! # Scenarios
//!
//! A trial meets the doors, people and smoke of the [`EnvironmentScenario`](bevy_envgen::EnvironmentScenario) of its
//! environment, from their start on: the same as in the flat simulator. The log holds them, and a replay gives
//! its environment those of the log. Commands of an app to their doors, and everything else that an app adds to the
//! world, are not in the log. Another scenario in the environment lets the trial begin again, as another world does.

mod bodies;
mod camera;
mod headless;
mod physics;
mod run;

use std::sync::Arc;

use bevy::ecs::change_detection::Tick;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_envgen::scenario::ScenarioError;
use bevy_rapier2d::prelude::PhysicsSet;
use mapping_trial::backend::Command;
use mapping_trial::trial::{Trial, TrialError, TrialLog, TrialParts, TrialSettings};
use thiserror::Error;

pub use bodies::RapierRobots;
use camera::Camera;
pub use headless::{
    HeadlessError, replay_headless, replay_headless_with, run_headless, run_headless_with,
};
#[cfg(feature = "camera")]
pub(crate) use headless::{drive, set_up};
pub use physics::ForTrials;
#[cfg(feature = "camera")]
pub(crate) use run::in_world;

use crate::robot::{RobotPlugin, RobotSystems};

/// The name of the robot backend in logs.
pub const ENGINE: &str = "rapier";

/// The systems of trials, before and after those of robots.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrialSystems {
    /// Processes what the robots sensed and commands them; begins and ends trials.
    Command,
    /// Records the robots' new poses and measurements.
    Record,
}

/// Runs the trials of [`MappingTrial`] components. Adds [`RobotPlugin`] to the same schedule,
/// unless it is added already.
#[derive(Clone, Copy, Debug)]
pub struct TrialPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl TrialPlugin {
    /// Runs the systems in `schedule` instead of `FixedUpdate`; it must be rapier's schedule.
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
            .configure_sets(
                self.schedule,
                (
                    TrialSystems::Command.before(RobotSystems::Drive),
                    TrialSystems::Record.after(RobotSystems::Sense).after(PhysicsSet::Writeback),
                ),
            )
            .add_systems(
                self.schedule,
                (
                    (run::begin, run::command).chain().in_set(TrialSystems::Command),
                    run::record.in_set(TrialSystems::Record),
                ),
            );
    }
}

/// A mapping trial in the world of the [`Environment`](bevy_envgen::Environment) on the same entity.
///
/// It begins once the world is ready: its robots are spawned as children of the environment, with
/// the component [`TrialRobot`], and [`TrialStarted`] is triggered. When the environment gets
/// another world, the trial begins again. Removing the component or despawning the environment
/// removes the robots. The events are [`TrialStarted`], [`TrialEnded`] and [`TrialFailed`].
#[derive(Component, Reflect)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct MappingTrial {
    /// Simulated seconds so far, for inspectors.
    time: f64,
    #[reflect(ignore)]
    ask: Request,
    /// Custom parts that replace built-in ones.
    #[reflect(ignore)]
    parts: TrialParts,
    #[reflect(ignore)]
    state: State,
}

/// What trial was requested.
enum Request {
    New(Box<TrialSettings>),
    Replay(Box<TrialLog>),
}

/// The state of a trial.
enum State {
    /// The world is not ready.
    Waiting,
    /// Robots were spawned, but rapier has not created their bodies.
    Warming(Box<Run>),
    Running(Box<Run>),
    Over(Box<Run>),
    /// The trial cannot begin in this place.
    Failed(Place),
}

/// Where a trial is: the world, and the scenario by the tick of its beginning.
#[derive(Clone)]
struct Place {
    world: Arc<envgen::World>,
    scenario: Option<Tick>,
}

/// A trial that has begun.
struct Run {
    trial: Trial<RapierRobots>,
    place: Place,
    camera: Camera,
    robots: Vec<Entity>,
    /// Number of scans of each robot that the trial has processed.
    scans: Vec<u64>,
    /// The remaining commands of the log, for each robot.
    script: Vec<std::vec::IntoIter<Command>>,
}

impl MappingTrial {
    /// A trial with these settings. If their exploration policy is `None`, the commands are those of
    /// [`ManualControl`].
    pub fn new(settings: TrialSettings) -> Self {
        MappingTrial::of(Request::New(Box::new(settings)))
    }

    /// Replays a log of engine [`ENGINE`]; the environment's world must be the log's.
    pub fn replay(log: TrialLog) -> Self {
        MappingTrial::of(Request::Replay(Box::new(log)))
    }

    fn of(ask: Request) -> Self {
        MappingTrial { time: 0.0, ask, parts: TrialParts::default(), state: State::Waiting }
    }

    /// Uses a custom SLAM, exploration policy or sensors, in place of those of the settings.
    #[must_use]
    pub fn with_parts(self, parts: TrialParts) -> Self {
        MappingTrial { parts, ..self }
    }

    /// The trial up to now; `None` before it begins.
    pub fn trial(&self) -> Option<&Trial<RapierRobots>> {
        self.run().map(|run| &run.trial)
    }

    /// The robots' entities, in the order of the trial; empty before it begins.
    pub fn robots(&self) -> &[Entity] {
        self.run().map_or(&[], |run| &run.robots)
    }

    /// Whether it has ended; a replay ends with the commands of the log.
    pub fn is_over(&self) -> bool {
        matches!(self.state, State::Over(_))
    }

    /// Whether it cannot begin in the current world: see [`TrialFailed`].
    pub fn has_failed(&self) -> bool {
        matches!(self.state, State::Failed(_))
    }

    /// Ends the trial in the next tick, for every robot that is still driving.
    pub fn stop(&mut self) {
        if let State::Warming(run) | State::Running(run) = &mut self.state {
            run.trial.stop();
        }
    }

    fn run(&self) -> Option<&Run> {
        match &self.state {
            State::Warming(run) | State::Running(run) | State::Over(run) => Some(run),
            State::Waiting | State::Failed(_) => None,
        }
    }

    /// The trial itself, if it has ended.
    fn into_trial(self) -> Option<Trial<RapierRobots>> {
        match self.state {
            State::Over(run) => Some(run.trial),
            _ => None,
        }
    }
}

/// Commands of a person, one per robot, next to a [`MappingTrial`]. While the component exists, they
/// replace those of the exploration policy. Robots without a command stop.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct ManualControl {
    /// One command per robot, in the order of the trial.
    pub commands: Vec<Command>,
}

/// A robot of a [`MappingTrial`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialRobot {
    /// Its number in the trial, from 0.
    pub index: usize,
}

/// Triggered on an environment when its trial begins.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialStarted {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment when its trial has ended.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialEnded {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment when its trial cannot begin.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialFailed {
    /// The environment.
    pub entity: Entity,
    /// Why.
    pub error: MappingTrialError,
}

/// Why a trial cannot begin in an environment.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MappingTrialError {
    /// The settings, the start or the log is invalid.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// Bevy's fixed step is not a tick.
    #[error(
        "the fixed step is {found} s, but a trial needs {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    FixedStep {
        /// Seconds of the fixed step.
        found: f64,
    },
    /// Rapier's step is not a tick.
    #[error(
        "rapier's step is {found}, but a trial needs a fixed {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    RapierStep {
        /// The mode of rapier's steps.
        found: String,
    },
    /// The log was made with another engine.
    #[error("the log's engine must be `{ENGINE}` to be replayed here, got `{found}`")]
    Engine {
        /// The log's engine.
        found: String,
    },
    /// The environment's doors, people or smoke cannot be.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The environment is scaled.
    #[error("the environment's scale must be 1 for a trial, got {found}")]
    Scale {
        /// The scale.
        found: Vec3,
    },
}
