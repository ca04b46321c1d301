//! Landscapes: grids of classes with a given entropy and Total Edge.
//!
//! Source: A. V. Kuznetsov, Generation of a random landscape by given configuration entropy and Total Edge,
//! Computational Technologies 22 (4), 2017, <http://ict.nsc.ru/jct/annotation/1808?l=eng>. Entropy is the Shannon
//! entropy of the classes' shares in nats (SHDI in ecology); Total Edge is the number of sides between cells of
//! different class. The paper reaches the entropy and approximates the Total Edge. Here the entropy
//! is as near as counts near a geometric sequence allow, and the Total Edge is the given one where such a landscape is
//! found.
//!
//! - [`Composition`]: from an entropy to the number of cells of each class.
//! - [`random_fill`] and [`automaton_fill`]: the paper's two algorithms. [`published`]: its formulas, with their
//!   limits.
//! - [`LandscapeSpec`] and [`Landscape`]: the settings, with entropy and Total Edge together in five algorithms,
//!   and the landscape.
//! - [`metrics`]: the metrics of landscape ecology for any raster of classes.
//! - `paths`: travel costs, least-cost paths and cost fields.

mod arrange;
mod blueprint;
mod composition;
mod construct;
mod edge;
mod error;
mod generate;
pub mod metrics;
mod noise;
mod outlines;
#[cfg(feature = "paths")]
pub mod paths;
pub mod published;
mod random_fill;
mod region;
mod search;
mod spec;
mod world;

pub use arrange::automaton_fill;
pub use blueprint::Landscape;
pub use composition::{Composition, entropy_of, largest_entropy};
pub use construct::least_built;
pub use edge::{
    edge_count, edge_lower_bound, edge_upper_bound, inner_sides, least_cut, mean_edge_count,
};
pub use error::LandscapeError;
pub use metrics::LandscapeMetrics;
pub(crate) use outlines::outlines;
pub use random_fill::random_fill;
#[cfg(feature = "paths")]
pub(crate) use region::largest_region;
pub use spec::{Algorithm, ClassOrder, LandscapeSpec, MAX_CELLS, MAX_SMOOTH_CELLS};
pub(crate) use world::raster_world;

use crate::error::SpecError;
use crate::generate::{Blueprint, Spec};
use crate::seed::Seed;
use crate::settings::Setting;
use crate::world::World;

impl Spec for LandscapeSpec {
    type Blueprint = Landscape;
    type Error = LandscapeError;

    const KIND: &'static str = "landscape";

    const VALUE_VERSION: u32 = 1;

    const SETTINGS: &'static [Setting] = LandscapeSpec::SETTINGS;

    const RULES: &'static [&'static str] = spec::RULES;

    fn validate(&self) -> Result<(), SpecError> {
        self.composition().map(|_| ())
    }

    fn work(&self) -> f64 {
        self.cells()
    }

    fn generate(&self, seed: Seed) -> Result<Landscape, LandscapeError> {
        generate::landscape(self, seed)
    }
}

impl Blueprint for Landscape {
    type Metrics = LandscapeMetrics;

    fn metrics(&self) -> LandscapeMetrics {
        metrics::measure(self)
    }

    fn to_world(&self) -> World {
        world::world(self)
    }
}
