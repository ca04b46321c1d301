//! Markov hallways: corridors whose turns follow a Markov chain and that never cross themselves.
//!
//! Source: C. Richter, W. Vega-Brown and N. Roy, Markov Chain Hallway and Poisson Forest
//! Environment Generating Distributions, MIT-CSAIL-TR-2015-014, section 1.
//!
//! - [`HallwayChain`]: the eight states, the transition matrix, its stationary law, sampling and
//!   estimation from a history of states.
//! - [`HallwaySpec`] and [`Hallway`]: the settings, and the states that were drawn.
//! - [`HallwayLayout`]: the corridor's centreline and walls in metres.

mod build;
mod chain;
mod feature;
mod layout;
mod spec;

pub use chain::{Estimate, HallwayChain, HistoryError, Proportion, State};
pub use feature::{Feature, FeatureKind, Side};
pub use layout::HallwayLayout;
pub use spec::{Corners, Ends, Hallway, HallwayMetrics, HallwaySpec, Start};
