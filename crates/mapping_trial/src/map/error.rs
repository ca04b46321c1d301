//! Errors of maps.

use thiserror::Error;

/// An error for which a file's map cannot become an [`OccupancyMap`](super::OccupancyMap).
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MapError {
    /// The map would be too large for cells of 0.05 m.
    #[error("the area of the map must be at most {most:.0} m^2, got {width:.1} m x {height:.1} m")]
    Area {
        /// The width along x in metres.
        width: f64,
        /// The height along y in metres.
        height: f64,
        /// The greatest area in square metres that is allowed.
        most: f64,
    },
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
