//! Poisson forests.

mod spec;

pub use spec::{Forest, ForestError, ForestMetrics, ForestSpec};
