//! Landscapes: grids of classes with a given entropy and Total Edge.
//!
//! Source: A. V. Kuznetsov, Generation of a random landscape by given configuration entropy and
//! Total Edge, Computational Technologies 22 (4), 2017. Entropy is the Shannon entropy of the
//! classes' shares in nats (what ecology calls SHDI), Total Edge the number of sides between cells
//! of different class. The paper reaches the first and approximates the second; here both are exact.
//!
//! - [`Composition`]: from an entropy to the number of cells of each class.
//! - [`random_fill`] and [`automaton_fill`]: the paper's two algorithms; [`published`]: its
//!   formulas, with their limits.
//! - [`LandscapeSpec`] and [`Landscape`]: the settings, entropy and Total Edge together in five
//!   algorithms, and the landscape.
//! - [`metrics`]: the measures of landscape ecology for any raster of classes.
//! - [`paths`]: costs of travel, least-cost paths and cost fields.

mod automaton;
mod blueprint;
mod build;
mod composition;
mod construct;
mod edge;
mod generate;
pub mod metrics;
pub mod paths;
pub mod published;
mod random_fill;
mod search;
mod smooth;
mod spec;

pub use automaton::automaton_fill;
pub use blueprint::{Landscape, LandscapeMetrics};
pub(crate) use build::{largest_region, raster_world};
pub use composition::{Composition, entropy_of, largest_entropy};
pub use edge::{
    edge_count, edge_lower_bound, edge_upper_bound, inner_sides, least_cut, mean_edge_count,
};
pub use generate::{automaton_epsilon, least_built};
pub use random_fill::random_fill;
pub use spec::{Algorithm, ClassOrder, LandscapeError, LandscapeSpec, MAX_CELLS, MAX_SMOOTH_CELLS};
