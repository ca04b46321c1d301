//! Errors of maps.

use envgen::occupancy::OccupancyError;
use thiserror::Error;

/// An error for which a file's map cannot become an [`OccupancyMap`](super::OccupancyMap).
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MapError {
    /// The map would have too many cells.
    #[error(transparent)]
    Cells(#[from] OccupancyError),
    /// The map would be too long in one direction.
    #[error("the {side} of the map must be at most {most} m in whole tiles, got {length:.1} m")]
    Side {
        /// The side: `width` along x, or `height` along y.
        side: &'static str,
        /// Its length in metres.
        length: f64,
        /// The greatest length in metres that is allowed.
        most: f64,
    },
    /// The map would be too far from the origin.
    #[error("the map must be within {most:e} m of the origin, got {distance:e} m")]
    Far {
        /// The greatest coordinate in metres.
        distance: f64,
        /// The greatest coordinate in metres that is allowed.
        most: f64,
    },
}
