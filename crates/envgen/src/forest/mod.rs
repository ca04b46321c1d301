//! Poisson forests: uniformly scattered trees, whose number follows a Poisson distribution.
//!
//! Source: C. Richter, W. Vega-Brown and N. Roy, Markov Chain Hallway and Poisson Forest
//! Environment Generating Distributions, MIT-CSAIL-TR-2015-014, section 2, <https://studylib.net/doc/10593763/>.
//!
//! - [`ForestSpec`] and [`Forest`]: a rectangular forest, with an optional least distance between trees, a
//!   distribution of radii, and a density that may vary.
//! - [`EndlessForest`]: a forest without borders, generated tile by tile.
//! - [`ForestMetrics`]: metrics of a forest, and the values that theory predicts for them.

mod blueprint;
#[cfg(feature = "rand")]
mod custom_laws;
mod density;
mod endless;
mod error;
mod generate;
mod hard_core;
mod index;
mod metrics;
mod poisson;
mod predict;
mod radius;
mod spec;
mod start_goal;
mod world;

pub use blueprint::Forest;
#[cfg(feature = "rand")]
pub use custom_laws::ForestLaws;
pub use density::{Density, DensityMap};
pub use endless::EndlessForest;
pub use error::ForestError;
pub use metrics::{ForestMetrics, PERCOLATION_THRESHOLD};
pub use spec::{Border, ForestSpec, MAX_HARD_CORE_TREES, MAX_TREES, RadiusLaw};

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for ForestSpec {
    type Blueprint = Forest;
    type Error = ForestError;

    const KIND: &'static str = "forest";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = ForestSpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.check()
    }

    fn work(&self) -> f64 {
        self.expected_trees()
    }

    fn generate(&self, seed: Seed) -> Result<Forest, ForestError> {
        self.validate()?;
        match &self.density {
            None => generate::plant(self, seed, None, None),
            Some(map) => {
                generate::plant(self, seed, Some(&map.over(self.area(), self.intensity)), None)
            }
        }
    }
}

impl Blueprint for Forest {
    type Metrics = ForestMetrics;

    fn metrics(&self) -> ForestMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
