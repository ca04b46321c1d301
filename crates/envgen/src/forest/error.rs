//! Why a forest could not be generated.

use thiserror::Error;

use crate::error::SpecError;

/// Why a forest could not be generated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ForestError {
    /// The spec asks for something that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The drawn number of trees does not fit at the least distance.
    #[error(
        "`min_distance` must be less, got {distance} m: {trees} trees were drawn and the area \
         holds at most {capacity} at this distance"
    )]
    Capacity {
        /// The number of trees drawn.
        trees: u64,
        /// The number above which random placement does not end.
        capacity: f64,
        /// The least distance in metres.
        distance: f64,
    },
    /// Random placement did not find a position for every tree.
    #[error(
        "{placed} of {trees} trees were placed at a distance of {distance} m in {attempts} \
         attempts; ask for a lower `intensity` or `min_distance`"
    )]
    Attempts {
        /// The number of trees drawn.
        trees: u64,
        /// Trees that were placed.
        placed: u64,
        /// The attempts made.
        attempts: u64,
        /// The least distance in metres.
        distance: f64,
    },
    /// A density function gave a value outside of its own limits.
    #[error("the density at ({x}, {y}) must be a number from 0 to {max}, got {value}")]
    Density {
        /// Where, in metres.
        x: f64,
        /// Where, in metres.
        y: f64,
        /// What it gave.
        value: f64,
        /// The greatest value of its own limits.
        max: f64,
    },
    /// A law of radii that replaces the spec's gave a value outside of the spec's limits.
    #[error(
        "the law of `radii` must give numbers from {min} to {max} m, `radius_min` to `radius_max`, \
         got {value:?}"
    )]
    Radius {
        /// What it gave.
        value: f64,
        /// The least radius in metres, the spec's `radius_min`.
        min: f64,
        /// The greatest radius in metres, the spec's `radius_max`.
        max: f64,
    },
}
