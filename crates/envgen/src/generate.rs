//! The interface of all kinds: a spec and a seed give a blueprint, and a blueprint gives a world.

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
    /// The blueprint that the generator makes from the spec.
    type Blueprint: Blueprint;

    /// The error if a spec and a seed give no blueprint.
    type Error: std::error::Error + From<SpecError>;

    /// The kind's name, as on the command line.
    const KIND: &'static str;

    /// The value version, which rises when a spec and a seed give other values.
    const VALUE_VERSION: u32;

    /// The settings: one for each field of the spec.
    const SETTINGS: &'static [Setting];

    /// Rules about several settings, in addition to the limits of each: one sentence per rule, without a full stop,
    /// with the names of settings in backticks.
    const RULES: &'static [&'static str] = &[];

    /// Checks every field, and the rules about several fields.
    ///
    /// ```
    /// use envgen::{Spec, hallway::HallwaySpec};
    ///
    /// let error = HallwaySpec { p_st: 1.5, ..Default::default() }.validate().unwrap_err();
    /// assert_eq!(error.to_string(), "`p_st` must be a number from 0 to 1, got 1.5");
    /// // Fields are checked together too: the arms of a corridor must not share space.
    /// let wide = HallwaySpec { pitch: 2.5, width: 5.0, ..Default::default() };
    /// assert_eq!(wide.validate().unwrap_err().field, "width");
    /// ```
    ///
    /// # Errors
    /// Names the first setting that is not allowed, its value and the allowed values.
    fn validate(&self) -> Result<(), SpecError>;

    /// Estimates the cost of generating a blueprint: the approximate number of its parts, cells or points.
    fn work(&self) -> f64;

    /// Generates a blueprint. The same spec and seed always give the same one.
    ///
    /// # Errors
    /// When the spec is not valid, or when this seed has no blueprint that satisfies it.
    fn generate(&self, seed: Seed) -> Result<Self::Blueprint, Self::Error>;

    /// Returns the provenance of the world that this spec and `seed` give.
    ///
    /// ```
    /// use envgen::{Seed, Spec, WorldSpec, forest::ForestSpec};
    ///
    /// // It is enough to generate the world again.
    /// let spec = ForestSpec { robot_radius: 0.5, ..Default::default() };
    /// let provenance = spec.provenance(Seed(7));
    /// assert_eq!(WorldSpec::from_provenance(&provenance)?, spec.into());
    /// assert_eq!(provenance.seed, Some(Seed(7)));
    /// # Ok::<(), envgen::SettingsError>(())
    /// ```
    fn provenance(&self, seed: Seed) -> Provenance {
        let spec = serde_json::to_value(self).unwrap_or(Value::Null);
        Provenance::generated(Self::KIND, spec, seed, Self::VALUE_VERSION)
    }
}

/// The plan of a world in the generator's own terms. It serialises to the `blueprint` field of `envgen sample`.
pub trait Blueprint: Clone + Debug + PartialEq + Serialize {
    /// The numbers that describe a blueprint: the `metrics` field of `envgen sample`.
    type Metrics: Clone + Debug + PartialEq + Serialize;

    /// Measures the blueprint.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let hallway = HallwaySpec { segments: 80, ..Default::default() }.generate(Seed(7))?;
    /// let turns = hallway.states().iter().filter(|state| state.is_turn()).count();
    /// assert_eq!(hallway.metrics().turns, turns as u64);
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    fn metrics(&self) -> Self::Metrics;

    /// Builds the world in metres.
    fn to_world(&self) -> World;
}
