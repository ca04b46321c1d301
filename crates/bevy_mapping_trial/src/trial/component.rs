//! The components of trials, and what a trial keeps while it runs.

use std::sync::Arc;

use bevy::ecs::change_detection::Tick;
use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use mapping_trial::backend::Command;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};

use super::bodies::RapierRobots;
use super::camera::Camera;

/// A mapping trial in the world of the [`Environment`](bevy_envgen::Environment) on the same entity.
///
/// It begins once the world is ready: its robots are spawned as children of the environment, with
/// the component [`TrialRobot`], and [`TrialStarted`](super::TrialStarted) is triggered. When the
/// environment gets another world, the trial begins again; while it has none, such as while it is
/// tilted, there are no robots. Removing the component or despawning the environment removes the
/// robots. Until then the environment has the `EnvironmentColliders` that the robots need, also where an app inserts
/// others. A robot that is despawned ends its part in the trial. Scenes and clones do not hold it; their robots are
/// despawned. The events are
/// [`TrialStarted`](super::TrialStarted), [`TrialEnded`](super::TrialEnded) and
/// [`TrialFailed`](super::TrialFailed).
#[derive(Component, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct MappingTrial {
    /// Simulated seconds so far, for inspectors.
    pub(super) time: f64,
    #[reflect(ignore)]
    pub(super) ask: Request,
    /// Custom parts that replace built-in ones.
    #[reflect(ignore)]
    pub(super) parts: TrialParts,
    #[reflect(ignore)]
    pub(super) state: State,
}

/// What trial was requested.
pub(super) enum Request {
    New(Box<TrialSettings>),
    Replay(Box<TrialLog>),
}

/// The state of a trial.
pub(super) enum State {
    /// The world is not ready.
    Waiting,
    /// Robots were spawned, but rapier has not created their bodies.
    Warming(Box<Run>),
    Running(Box<Run>),
    Over(Box<Run>),
    /// The world has no end.
    Endless,
    /// The trial cannot begin in this place; whether time steps and scale suited it.
    Failed {
        place: Place,
        suited: bool,
    },
}

/// Where a trial is: the world, and the scenario by the tick of its beginning.
#[derive(Clone)]
pub(super) struct Place {
    pub(super) world: Arc<envgen::World>,
    pub(super) scenario: Option<Tick>,
}

/// A trial that has begun.
pub(super) struct Run {
    pub(super) trial: Trial<RapierRobots>,
    pub(super) place: Place,
    pub(super) camera: Camera,
    pub(super) robots: Vec<Entity>,
    /// Number of scans of each robot that the trial has processed.
    pub(super) scans: Vec<u64>,
    /// The remaining commands of the log, for each robot.
    pub(super) script: Vec<std::vec::IntoIter<Command>>,
}

impl MappingTrial {
    /// A trial with these settings. If their exploration policy is `None`, the commands are those of
    /// [`ManualControl`].
    pub fn new(settings: TrialSettings) -> Self {
        MappingTrial::of(Request::New(Box::new(settings)))
    }

    /// Replays a log of engine [`ENGINE`](super::ENGINE); the environment's world must be the log's. To the last bit
    /// where transform, origin and colliders are those of the environment that the log is from.
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

    /// Whether it cannot begin, or continue, in the current world: see [`TrialFailed`](super::TrialFailed).
    pub fn has_failed(&self) -> bool {
        matches!(self.state, State::Failed { .. } | State::Endless)
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
            State::Waiting | State::Failed { .. } | State::Endless => None,
        }
    }

    /// The trial itself, if it has ended.
    pub(super) fn into_trial(self) -> Option<Trial<RapierRobots>> {
        match self.state {
            State::Over(run) => Some(run.trial),
            _ => None,
        }
    }
}

/// Commands of a person, one per robot, next to a [`MappingTrial`]. While the component exists, they
/// replace those of the exploration policy. Robots without a command stop.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct ManualControl {
    /// One command per robot, in the order of the trial.
    pub commands: Vec<Command>,
}

/// A robot of a [`MappingTrial`]. Below an environment those that its trial has not spawned are despawned.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialRobot {
    /// Its number in the trial, from 0.
    pub index: usize,
}
