//! Why an indoor map could not be generated.

use thiserror::Error;

use crate::error::SpecError;

/// Why a plan could not be generated: the spec is not allowed, or a law that replaces the spec's gave a
/// number that is not.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum IndoorError {
    /// The spec asks for something that is not allowed.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The profile `calibrated` cannot predict the difficulty of its maps.
    #[error("no map has a predicted difficulty: {0}")]
    Unpredicted(String),
    /// A law of the distance between hallways.
    #[error("the law of `spacing` must give numbers from 3 to {max} cells, got {value:?}")]
    Spacing {
        /// What it gave.
        value: f64,
        /// The greatest distance in cells: one less than the map's width or height.
        max: u32,
    },
    /// A law of how far contents are moved.
    #[error("the law of `moves` must give numbers from -{max} to {max} m, got {value:?}")]
    Move {
        /// What it gave.
        value: f64,
        /// The greatest distance in metres, the size of the largest room.
        max: f64,
    },
    /// A law of how far contents are turned.
    #[error("the law of `turns` must give numbers from -{max} to {max} radians, got {value:?}")]
    Turn {
        /// What it gave.
        value: f64,
        /// The greatest angle in radians.
        max: f64,
    },
}
