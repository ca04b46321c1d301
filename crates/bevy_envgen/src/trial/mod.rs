//! Mapping trials in rapier: the brain, protocol, log and scores of [`mapping_trial`], with the
//! robots of [`crate::robot`] as its bodies.
//!
//! Put a [`MappingTrial`] on the entity of an [`Environment`](crate::Environment): once the world
//! stands, its robots are spawned as children of it, and the trial runs at 20 ticks a second.
//! [`run_headless`] does it all without an app of one's own.
//!
//! ```
//! use bevy_envgen::trial::run_headless;
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
//! `PhysicsSet`, [`RobotSystems::Sense`](crate::robot::RobotSystems), [`TrialSystems::Record`]. The
//! schedule's step must be [`TICK`](mapping_trial::backend::TICK), and rapier's with it:
//! [`TopDownPhysicsPlugin::for_trials`](crate::physics::TopDownPhysicsPlugin::for_trials) sets both.
//! The first tick after the robots were spawned only looks: rapier has to know them before the
//! first scan.
//!
//! # What replays
//!
//! A log of engine [`ENGINE`] runs again to the last bit with the same build of the program, on the
//! same kind of machine; rapier's floats are not the same everywhere. Doors that move, and whatever
//! else an app adds to the world, are not in the log.

mod bodies;
mod camera;
mod headless;
mod run;

use std::sync::Arc;

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier2d::prelude::PhysicsSet;
use mapping_trial::backend::Command;
use mapping_trial::trial::{Trial, TrialError, TrialLog, TrialParts, TrialSettings};
use thiserror::Error;

pub use bodies::RapierRobots;
use camera::Camera;
pub use headless::{HeadlessError, replay_headless, run_headless, run_headless_with};

use crate::physics::DoorSystems;
use crate::robot::{RobotPlugin, RobotSystems};

/// What moves the bodies, as logs name it.
pub const ENGINE: &str = "rapier";

/// The systems of trials, around those of robots.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrialSystems {
    /// What the robots sensed is taken in, and their commands are given; trials begin and end.
    Command,
    /// Where the robots are now is recorded.
    Record,
}

/// Runs the trials of [`MappingTrial`] components. Adds [`RobotPlugin`] to the same schedule, where
/// it is not there yet.
#[derive(Clone, Copy, Debug)]
pub struct TrialPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl TrialPlugin {
    /// With the systems in another schedule than `FixedUpdate`: rapier's.
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
                    TrialSystems::Command.after(DoorSystems).before(RobotSystems::Drive),
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

/// A mapping trial in the world of the [`Environment`](crate::Environment) on the same entity.
///
/// It begins once the world stands: its robots are spawned as children of the environment, with
/// the component [`TrialRobot`], and [`TrialStarted`] is triggered. Another world of the same
/// environment begins it anew; removing the component or despawning the environment removes the
/// robots. What happens is told by [`TrialStarted`], [`TrialEnded`] and [`TrialFailed`].
#[derive(Component, Reflect)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct MappingTrial {
    /// Simulated seconds so far, for inspectors.
    time: f64,
    #[reflect(ignore)]
    ask: Request,
    /// What takes the place of built-in parts.
    #[reflect(ignore)]
    parts: TrialParts,
    #[reflect(ignore)]
    state: State,
}

/// What a trial is to be.
enum Request {
    New(Box<TrialSettings>),
    Replay(Box<TrialLog>),
}

/// How far a trial has come.
enum State {
    /// There is no world yet.
    Waiting,
    /// Robots were spawned, and rapier does not know them yet.
    Warming(Box<Run>),
    Running(Box<Run>),
    Over(Box<Run>),
    /// It cannot begin in this world.
    Failed(Arc<envgen::World>),
}

/// A trial that has begun.
struct Run {
    trial: Trial<RapierRobots>,
    world: Arc<envgen::World>,
    camera: Camera,
    robots: Vec<Entity>,
    /// Scans of each robot that the trial has seen.
    scans: Vec<u64>,
    /// Each robot's commands of the log that are still to come.
    script: Vec<std::vec::IntoIter<Command>>,
}

impl MappingTrial {
    /// A trial of these settings. With an operator of `None` the commands are those of [`ManualControl`].
    pub fn new(settings: TrialSettings) -> Self {
        MappingTrial::of(Request::New(Box::new(settings)))
    }

    /// Runs a log of engine [`ENGINE`] again, whose world the environment must be.
    pub fn replay(log: TrialLog) -> Self {
        MappingTrial::of(Request::Replay(Box::new(log)))
    }

    fn of(ask: Request) -> Self {
        MappingTrial { time: 0.0, ask, parts: TrialParts::default(), state: State::Waiting }
    }

    /// With SLAM, operator or sensors of one's own, in place of those that the settings name.
    #[must_use]
    pub fn with_parts(self, parts: TrialParts) -> Self {
        MappingTrial { parts, ..self }
    }

    /// The trial as far as it went; `None` before it begins.
    pub fn trial(&self) -> Option<&Trial<RapierRobots>> {
        self.run().map(|run| &run.trial)
    }

    /// The robots' entities, in the order of the trial; none before it begins.
    pub fn robots(&self) -> &[Entity] {
        self.run().map_or(&[], |run| &run.robots)
    }

    /// Whether it has come to its end; a log, to the end of its commands.
    pub fn is_over(&self) -> bool {
        matches!(self.state, State::Over(_))
    }

    /// Whether it cannot begin in the world that stands: see [`TrialFailed`].
    pub fn has_failed(&self) -> bool {
        matches!(self.state, State::Failed(_))
    }

    /// Ends the trial, for every robot whose part has not ended yet, in the next tick.
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

    /// The trial itself, where it came to its end.
    fn into_trial(self) -> Option<Trial<RapierRobots>> {
        match self.state {
            State::Over(run) => Some(run.trial),
            _ => None,
        }
    }
}

/// A person's commands, one a robot, beside a [`MappingTrial`]: they take the operator's place as
/// long as the component is there. Robots without a command stand still.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct ManualControl {
    /// One command a robot.
    pub commands: Vec<Command>,
}

/// A robot of a [`MappingTrial`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialRobot {
    /// Its number in the trial, from 0.
    pub index: usize,
}

/// Triggered on an environment when the trial in it begins.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialStarted {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment when the trial in it is over.
#[derive(EntityEvent, Clone, Debug)]
pub struct TrialEnded {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment when the trial in it cannot begin.
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
    /// The settings, the start or the log.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// Bevy's fixed step is not a tick.
    #[error(
        "the fixed step is {found} s, a trial needs {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    FixedStep {
        /// Seconds of the fixed step.
        found: f64,
    },
    /// Rapier's step is not a tick.
    #[error(
        "rapier's step is {found}, a trial needs fixed ones of {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    RapierStep {
        /// The mode of rapier's steps.
        found: String,
    },
    /// Something else moved the bodies of the log.
    #[error("the log's engine is `{found}`, only `{ENGINE}` replays here")]
    Engine {
        /// The log's engine.
        found: String,
    },
    /// The environment is not as large as its world says.
    #[error("the environment has scale {found}, a trial needs 1")]
    Scale {
        /// The scale.
        found: Vec3,
    },
}
