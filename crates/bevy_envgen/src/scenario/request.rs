//! The component that requests a scenario, and the components and events with the outcome.

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use envgen::scenario::{Scenario, ScenarioSpec};
use envgen::{Seed, SpecError, World as EnvWorld};
use thiserror::Error;

/// A component that requests doors, people and smoke in the world of the [`Environment`](crate::Environment)
/// on the same entity.
///
/// The scenario begins when the world is spawned, and again when the world or this component changes. Each
/// time [`ScenarioStarted`] or [`ScenarioFailed`] is triggered. Removing the component removes the scenario.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct EnvironmentScenario {
    /// The source of the scenario: settings, or the scenario itself.
    pub source: ScenarioSource,
    /// The seed of everything random. It is not used for a scenario that already exists.
    pub seed: u64,
}

/// The source of a scenario.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, PartialEq, Clone)]
pub enum ScenarioSource {
    /// Settings, from which a scenario is drawn for whatever world the environment has.
    Spec(SourceScenarioSpec),
    /// A scenario with a list of its doors, people and sources of smoke. It fits only one world.
    Scenario(SourceScenario),
}

/// Settings as a value of a component. Scenes serialize them as [`ScenarioSpec`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceScenarioSpec(pub Box<ScenarioSpec>);

/// A scenario as a value of a component. Scenes serialize it as [`Scenario`].
#[derive(Clone, Debug, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Debug, PartialEq, Clone)]
pub struct SourceScenario(pub Box<Scenario>);

impl EnvironmentScenario {
    /// Creates a request for the scenario of settings and a seed.
    pub fn new(spec: ScenarioSpec, seed: u64) -> Self {
        EnvironmentScenario {
            source: ScenarioSource::Spec(SourceScenarioSpec(Box::new(spec))),
            seed,
        }
    }

    /// Creates a request for a scenario that already exists, such as one that was edited or read from a file.
    pub fn prebuilt(scenario: Scenario) -> Self {
        let source = ScenarioSource::Scenario(SourceScenario(Box::new(scenario)));
        EnvironmentScenario { source, seed: 0 }
    }

    /// Returns the scenario for a world.
    pub(super) fn of(&self, world: &EnvWorld) -> Result<Scenario, SpecError> {
        match &self.source {
            ScenarioSource::Spec(spec) => Scenario::new(world, spec, Seed(self.seed)),
            ScenarioSource::Scenario(scenario) => Ok((*scenario.0).clone()),
        }
    }
}

/// A component with the reason why the requested scenario could not begin. It is on the entity of the
/// environment until a scenario begins. Scenes do not hold it.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct ScenarioFailure(pub ScenarioError);

/// An error that prevents a scenario.
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

/// An event that is triggered on an environment, and written as a message, when its scenario begins, for the
/// first time or again.
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct ScenarioStarted {
    /// The environment.
    pub entity: Entity,
}

/// An event that is triggered on an environment, and written as a message, when its scenario cannot begin.
/// The error is also stored on the entity; see [`ScenarioFailure`].
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct ScenarioFailed {
    /// The environment.
    pub entity: Entity,
    /// The error.
    pub error: ScenarioError,
}

/// An event that restarts the scenario of the environment on which it is triggered, with new entities.
#[derive(EntityEvent, Clone, Debug)]
pub struct RestartScenario {
    /// The environment.
    pub entity: Entity,
}
