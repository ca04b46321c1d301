//! The interface of all kinds: a spec with a seed gives a blueprint, a blueprint gives a world.

use std::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::SpecError;
use crate::provenance::Provenance;
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

/// The settings of one kind of world.
pub trait Spec: Clone + Debug + Default + PartialEq + Serialize + DeserializeOwned {
    /// What the generator makes from the spec.
    type Blueprint: Blueprint;

    /// Why a spec and a seed have no blueprint.
    type Error: std::error::Error + From<SpecError>;

    /// The kind's name, as on the command line.
    const KIND: &'static str;

    /// The value version: it rises when a spec and a seed give other values.
    const VALUE_VERSION: u32;

    /// Every field of the spec.
    const SETTINGS: &'static [Setting];

    /// Rules between several settings, besides the limits of each: one sentence per rule, without a
    /// full stop, with the names of settings in backticks.
    const RULES: &'static [&'static str] = &[];

    /// Checks every field, and the fields together.
    ///
    /// # Errors
    /// Names the first setting that is not allowed, its value and the allowed values.
    fn validate(&self) -> Result<(), SpecError>;

    /// About how many parts, cells or points a blueprint has: the cost of generating it.
    fn work(&self) -> f64;

    /// Generates a blueprint; the same spec and seed always give the same one.
    ///
    /// # Errors
    /// When the spec is not valid, or when this seed has no blueprint that satisfies it.
    fn generate(&self, seed: Seed) -> Result<Self::Blueprint, Self::Error>;

    /// The provenance of the world that this spec and `seed` give.
    fn provenance(&self, seed: Seed) -> Provenance {
        let spec = serde_json::to_value(self).unwrap_or(Value::Null);
        Provenance::generated(Self::KIND, spec, seed, Self::VALUE_VERSION)
    }
}

/// The plan of a world that a generator makes, in the generator's own terms. It serialises to the
/// `blueprint` field of `envgen sample`.
pub trait Blueprint: Clone + Debug + PartialEq + Serialize {
    /// Numbers that describe it: the `metrics` field of `envgen sample`.
    type Metrics: Clone + Debug + PartialEq + Serialize;

    /// Measures the blueprint.
    fn metrics(&self) -> Self::Metrics;

    /// Builds the world in metres.
    fn to_world(&self) -> World;
}
