//! Errors of generating forests.

use thiserror::Error;

use crate::error::SpecError;

/// The reasons why a forest could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ForestError {
    /// The spec has a setting that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The drawn number of trees does not fit into the area at the least distance.
    #[error(
        "`min_distance` must be less, got {distance} m: {trees} trees were drawn and the area \
         holds at most {} at this distance",
        capacity.floor().max(1.0)
    )]
    Capacity {
        /// Number of trees drawn.
        trees: u64,
        /// The number above which random placement does not end.
        capacity: f64,
        /// The least distance between trees in metres.
        distance: f64,
    },
    /// Random placement did not find a position for every tree.
    #[error(
        "{placed} of {trees} trees were placed at a distance of {distance} m in {attempts} \
         attempts; ask for a lower `intensity` or `min_distance`"
    )]
    Attempts {
        /// Number of trees drawn.
        trees: u64,
        /// Number of trees that were placed.
        placed: u64,
        /// Number of attempts made.
        attempts: u64,
        /// The least distance between trees in metres.
        distance: f64,
    },
    /// A density function gave a value outside its own limits.
    #[error("the density at ({x}, {y}) must be a number from 0 to {max}, got {value}")]
    Density {
        /// The x coordinate of the point in metres.
        x: f64,
        /// The y coordinate of the point in metres.
        y: f64,
        /// The value that it gave.
        value: f64,
        /// The greatest value that it allows.
        max: f64,
    },
    /// A distribution of radii that replaces the spec's gave a value outside the spec's limits.
    #[error(
        "the law of `radii` must give numbers from {min} to {max} m, `radius_min` to `radius_max`, \
         got {value:?}"
    )]
    Radius {
        /// The value that it gave.
        value: f64,
        /// The least radius in metres, the spec's `radius_min`.
        min: f64,
        /// The greatest radius in metres, the spec's `radius_max`.
        max: f64,
    },
}
