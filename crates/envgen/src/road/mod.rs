//! Procedural roads: a length is divided at random among straights and turns.
//!
//! Source: [Pseudo-random procedural roads](https://pim-n.github.io/pg-rad/explainers/prefab_roads/), in the
//! documentation of `pg-rad`: the lengths of a list of prefabs follow a Dirichlet distribution, and the radius of a
//! turn is uniform between the limits given by speed and angle.
//!
//! - [`RoadSpec`] and [`Road`]: the settings, and the drawn road with its exact centreline.
//! - [`dirichlet`], [`lengths`], [`largest_remainder`]: the division of the length.
//! - [`TurnLimits`]: the allowed radii of a turn.
//!
//! There are two differences from the source. All lengths are in metres, whereas the source's code uses numbers of
//! waypoints as metres, so that its radii change with the step. And `lengths` = `reserve` leaves every turn the
//! length that it needs, whereas the source has no valid radius for a turn that is too short.

mod apportion;
mod blueprint;
mod custom_laws;
mod dirichlet;
mod error;
mod fit;
mod generate;
mod metrics;
mod part;
mod spec;
mod turn;
mod waypoints;
mod world;

pub use apportion::{largest_remainder, lengths, quantum};
pub use blueprint::{Road, RoadSegment, SegmentKind};
#[cfg(feature = "rand")]
pub use custom_laws::RoadLaws;
pub use dirichlet::{Concentration, dirichlet};
pub use error::RoadError;
pub use metrics::RoadMetrics;
pub use spec::{Crossing, Lengths, MAX_SEGMENTS, MAX_WAYPOINTS, Prefab, RoadSpec};
pub use turn::{GRAVITY, TurnLaw, TurnLimits};
pub use world::KERB_TOLERANCE;

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for RoadSpec {
    type Blueprint = Road;
    type Error = RoadError;

    const KIND: &'static str = "road";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = RoadSpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.check()
    }

    fn work(&self) -> f64 {
        self.length / self.step
    }

    fn generate(&self, seed: Seed) -> Result<Road, RoadError> {
        self.validate()?;
        generate::road(self, seed, &custom_laws::RoadLaws::default())
    }
}

impl Blueprint for Road {
    type Metrics = RoadMetrics;

    fn metrics(&self) -> RoadMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
