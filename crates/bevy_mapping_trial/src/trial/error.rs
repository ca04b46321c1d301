//! The errors that prevent a trial in an environment.

use bevy::prelude::*;
use bevy_envgen::scenario::ScenarioError;
use mapping_trial::trial::TrialError;
use thiserror::Error;

use super::bodies::ENGINE;

/// An error that prevents a trial in an environment.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MappingTrialError {
    /// The settings, the start or the log is invalid.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// Bevy's fixed step, or the step of the schedule of trials, is not a tick.
    #[error(
        "time advances by {found} s per step, but a trial needs {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    FixedStep {
        /// The step in seconds.
        found: f64,
    },
    /// Rapier's step is not a tick.
    #[error(
        "rapier's step is {found}, but a trial needs a fixed {} s: use `TopDownPhysicsPlugin::for_trials`",
        mapping_trial::backend::TICK
    )]
    RapierStep {
        /// The time step mode of rapier.
        found: String,
    },
    /// The log was made with another engine.
    #[error("the log's engine must be `{ENGINE}` to be replayed here, got `{found}`")]
    Engine {
        /// The engine of the log.
        found: String,
    },
    /// The doors, people or smoke of the environment are invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The entity of the trial has no environment.
    #[error("a trial needs the component `Environment` on its entity")]
    NoEnvironment,
    /// The world of the environment is endless.
    #[error("a trial needs a world with an end, but the environment's is endless")]
    Endless,
    /// The environment is scaled.
    #[error("the environment's scale must be 1 for a trial, got {found}")]
    Scale {
        /// The scale of the environment.
        found: Vec3,
    },
}
