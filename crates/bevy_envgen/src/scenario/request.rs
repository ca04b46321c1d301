//! The component that asks for a scenario, and what is reported.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::{Seed, SpecError, World as EnvWorld};
use thiserror::Error;

/// Asks for doors, people and smoke in the world of the [`Environment`](crate::Environment) on the same entity.
///
/// They begin once the world is there, and begin again when the world or this component changes; then
/// [`ScenarioStarted`] is triggered, or [`ScenarioFailed`]. Removing the component removes them.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct EnvironmentScenario {
    /// The settings, or the scenario itself.
    pub source: ScenarioSource,
    /// Determines everything random. Unused for a scenario that exists already.
    pub seed: u64,
}

/// Where a scenario comes from.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub enum ScenarioSource {
    /// Settings, from which it is drawn in whatever world the environment has.
    Spec(SourceScenarioSpec),
    /// A scenario whose doors, people and sources of smoke are listed; it fits one world alone.
    Scenario(SourceScenario),
}

/// Settings as a value that scenes can hold, serialized as [`ScenarioSpec`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceScenarioSpec(pub Box<ScenarioSpec>);

/// A scenario as a value that scenes can hold, serialized as [`Scenario`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceScenario(pub Box<Scenario>);

impl EnvironmentScenario {
    /// The scenario of settings and a seed.
    pub fn new(spec: ScenarioSpec, seed: u64) -> Self {
        EnvironmentScenario {
            source: ScenarioSource::Spec(SourceScenarioSpec(Box::new(spec))),
            seed,
        }
    }

    /// A scenario that exists already: edited, or read from a file.
    pub fn prebuilt(scenario: Scenario) -> Self {
        let source = ScenarioSource::Scenario(SourceScenario(Box::new(scenario)));
        EnvironmentScenario { source, seed: 0 }
    }

    /// The scenario in a world.
    pub(super) fn of(&self, world: &EnvWorld) -> Result<Scenario, SpecError> {
        match &self.source {
            ScenarioSource::Spec(spec) => Scenario::new(world, spec, Seed(self.seed)),
            ScenarioSource::Scenario(scenario) => Ok((*scenario.0).clone()),
        }
    }
}

/// Why an environment has no scenario although it is asked for one. On its entity until one begins; scenes do not
/// hold it.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct ScenarioFailure(pub ScenarioError);

/// Why a scenario cannot begin.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// A setting is out of range, or the scenario does not fit the world.
    #[error("the scenario does not fit: {0}")]
    Spec(#[from] SpecError),
    /// The world is endless.
    #[error("an endless world cannot have doors, people or smoke")]
    Endless,
}

/// Triggered on an environment, and written as a message, when its scenario begins: the first time, and when it
/// begins again.
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct ScenarioStarted {
    /// The environment.
    pub entity: Entity,
}

/// Triggered on an environment, and written as a message, when its scenario cannot begin. The error is also stored
/// on the entity: see [`ScenarioFailure`].
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct ScenarioFailed {
    /// The environment.
    pub entity: Entity,
    /// Why.
    pub error: ScenarioError,
}

/// Trigger it on an environment to let its scenario begin again, with other entities.
#[derive(EntityEvent, Clone, Debug)]
pub struct RestartScenario {
    /// The environment.
    pub entity: Entity,
}
