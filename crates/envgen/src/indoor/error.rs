//! Errors of generating indoor maps.

use thiserror::Error;

use crate::error::SpecError;

/// The reasons why a plan could not be generated: the spec is not allowed, its difficulty cannot be predicted, or a
/// distribution that replaces the spec's gave a number that is not allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum IndoorError {
    /// The spec has a setting that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The profile `calibrated` cannot predict the difficulty of the maps of this spec.
    #[error("no map has a predicted difficulty: {0}")]
    Unpredicted(String),
    /// A distribution of the distance between hallways gave a number that is not allowed.
    #[error("the law of `spacing` must give numbers from 3 to {max} cells, got {value:?}")]
    Spacing {
        /// The number that it gave.
        value: f64,
        /// The greatest distance in cells: one less than the map's width or height.
        max: u32,
    },
    /// A distribution of moves of contents gave a number that is not allowed.
    #[error("the law of `moves` must give numbers from -{max} to {max} m, got {value:?}")]
    Move {
        /// The number that it gave.
        value: f64,
        /// The greatest distance in metres, the size of the largest room.
        max: f64,
    },
    /// A distribution of turns of contents gave a number that is not allowed.
    #[error("the law of `turns` must give numbers from -{max} to {max} radians, got {value:?}")]
    Turn {
        /// The number that it gave.
        value: f64,
        /// The greatest angle in radians.
        max: f64,
    },
}
