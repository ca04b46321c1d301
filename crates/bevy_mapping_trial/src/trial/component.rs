//! The components of trials, and the state of a running trial.

use std::sync::Arc;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use mapping_trial::backend::Command;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};

use super::bodies::RapierRobots;
use super::camera::Camera;
use super::error::MappingTrialError;

/// A component that runs a mapping trial in the world of the [`Environment`](bevy_envgen::Environment) on the
/// same entity.
///
/// The trial begins once the world is ready: its robots are spawned as children of the environment, with the
/// component [`TrialRobot`], and [`TrialStarted`](super::TrialStarted) is triggered. When the environment
/// gets another world, or its world is rebuilt, the trial begins again, even if it has ended: take what you
/// need of an ended trial before. While there is no world, for example while the environment is tilted, there
/// are no robots. Without an environment, the trial fails until there is one. A robot that is despawned no
/// longer takes part in the trial.
///
/// Removing the component or despawning the environment removes the robots. Until then the environment has
/// the `EnvironmentColliders` that the robots need, even if an app inserts others or removes them. Scenes and
/// clones do not hold this component, and their robots are despawned.
///
/// Robots meet only what is spawned. If the world is streamed, the radius of
/// [`StreamAround`](bevy_envgen::StreamAround) must include everything that their lasers reach.
///
/// The events are [`TrialStarted`](super::TrialStarted), [`TrialEnded`](super::TrialEnded) and
/// [`TrialFailed`](super::TrialFailed).
#[derive(Component, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
pub struct MappingTrial {
    /// The simulated seconds so far, for inspectors.
    pub(super) time: f64,
    #[reflect(ignore)]
    pub(super) ask: Request,
    /// Custom parts that replace built-in ones.
    #[reflect(ignore)]
    pub(super) parts: TrialParts,
    #[reflect(ignore)]
    pub(super) state: State,
}

/// The trial that was requested.
pub(super) enum Request {
    New(Box<TrialSettings>),
    Replay(Box<TrialLog>),
}

/// The state of a trial.
pub(super) enum State {
    /// The world is not ready.
    Waiting,
    /// The robots are spawned, but rapier has not created their bodies yet.
    Warming(Box<Run>),
    Running(Box<Run>),
    Over(Box<Run>),
    /// There is no environment, or its world is endless.
    Nowhere(MappingTrialError),
    /// The trial cannot begin in this place. `suited` is whether time steps and scale were valid, and
    /// `has_scenario_failed` whether the scenario of the environment was not.
    Failed {
        place: Place,
        suited: bool,
        has_scenario_failed: bool,
    },
}

/// The place of a trial: the world, and the number of the run of its scenario.
#[derive(Clone)]
pub(super) struct Place {
    pub(super) world: Arc<envgen::World>,
    pub(super) scenario: Option<u64>,
}

/// A trial that has begun.
pub(super) struct Run {
    pub(super) trial: Trial<RapierRobots>,
    pub(super) place: Place,
    pub(super) camera: Camera,
    pub(super) robots: Vec<Entity>,
    /// The number of scans of each robot that the trial has processed.
    pub(super) scans: Vec<u64>,
    /// The remaining commands of the log, for each robot.
    pub(super) script: Vec<std::vec::IntoIter<Command>>,
}

impl MappingTrial {
    /// Creates a trial with these settings. If their exploration policy is `None`, the commands are those of
    /// [`ManualControl`].
    pub fn new(settings: TrialSettings) -> Self {
        MappingTrial::of(Request::New(Box::new(settings)))
    }

    /// Creates the replay of a log of engine [`ENGINE`](super::ENGINE). The world of the environment must be
    /// that of the log. The replay is exact to the last bit if transform, origin and colliders are those of
    /// the environment in which the log was made.
    ///
    /// Until the component is removed, the doors, people and smoke of the log replace those that the
    /// [`EnvironmentScenario`](bevy_envgen::EnvironmentScenario) of the environment requests. Then the original
    /// request is restored, unless the app has inserted another one.
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

    /// Returns the trial in its current state, or `None` before it has begun.
    pub fn trial(&self) -> Option<&Trial<RapierRobots>> {
        self.run().map(|run| &run.trial)
    }

    /// Returns the entities of the robots, in the order of the trial. It is empty before the trial has begun.
    pub fn robots(&self) -> &[Entity] {
        self.run().map_or(&[], |run| &run.robots)
    }

    /// Returns whether the trial has ended. A replay ends with the commands of the log.
    pub fn is_over(&self) -> bool {
        matches!(self.state, State::Over(_))
    }

    /// Returns whether the trial cannot begin, or continue, in the current world; see
    /// [`TrialFailed`](super::TrialFailed).
    pub fn has_failed(&self) -> bool {
        matches!(self.state, State::Failed { .. } | State::Nowhere(_))
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
            State::Waiting | State::Failed { .. } | State::Nowhere(_) => None,
        }
    }

    /// Returns the trial itself, if it has ended.
    pub(super) fn into_trial(self) -> Option<Trial<RapierRobots>> {
        match self.state {
            State::Over(run) => Some(run.trial),
            _ => None,
        }
    }
}

/// A component with the commands of an operator, one per robot, on the entity of a [`MappingTrial`]. While it
/// exists, its commands replace those of the exploration policy. Robots without a command stop.
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

/// A component of a robot of a [`MappingTrial`]. Entities below an environment that have it, but were not
/// spawned by the trial, are despawned.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TrialRobot {
    /// The number of the robot in the trial, counted from 0.
    pub index: usize,
}
