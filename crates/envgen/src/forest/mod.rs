//! Poisson forests: trees scattered uniformly, their number drawn from a Poisson law.
//!
//! Source: C. Richter, W. Vega-Brown and N. Roy, Markov Chain Hallway and Poisson Forest
//! Environment Generating Distributions, MIT-CSAIL-TR-2015-014, section 2.
//!
//! - [`ForestSpec`] and [`Forest`]: a rectangular forest, with a least distance between trees, a
//!   law of radii and a density that may vary.
//! - [`EndlessForest`]: a forest without borders, tile by tile.
//! - [`ForestMetrics`]: measures of a forest, and what theory predicts for them.

mod density;
mod endless;
mod hard_core;
mod index;
#[cfg(feature = "rand")]
mod laws;
mod metrics;
mod poisson;
mod predict;
mod radius;
mod spec;
mod start_goal;

pub use density::{Density, DensityMap};
pub use endless::EndlessForest;
#[cfg(feature = "rand")]
pub use laws::ForestLaws;
pub use metrics::{ForestMetrics, PERCOLATION_THRESHOLD};
pub use radius::RadiusLaw;
pub use spec::{Border, Forest, ForestError, ForestSpec, MAX_HARD_CORE_TREES, MAX_TREES};
