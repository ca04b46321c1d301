//! Errors of computing difficulty vectors.

use thiserror::Error;

use super::limits::{MAX_CELL, MAX_CELLS, MAX_READS};
use crate::error::SpecError;
use crate::occupancy::OccupancyError;
use crate::world::Violation;

/// The reasons why a world has no difficulty vector for a robot.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DifficultyError {
    /// A number of the robot or of its laser is not allowed.
    #[error(transparent)]
    Platform(#[from] SpecError),
    /// The world breaks an invariant.
    #[error("the world is broken: {0}")]
    World(#[from] Violation),
    /// The grid of the world would be too large.
    #[error(transparent)]
    Size(#[from] OccupancyError),
    /// The world is too large for cells of [`MAX_CELL`].
    #[error(
        "the bounds of the world must hold at most {MAX_CELLS} cells of {MAX_CELL} m, got {width} m x {height} m"
    )]
    TooLarge {
        /// Width of the bounds in metres.
        width: f64,
        /// Height of the bounds in metres.
        height: f64,
    },
    /// So many solids are near each other that the clearances would take more than [`MAX_READS`] distances to solids.
    #[error(
        "the solids of the world are too dense: their clearances must take at most {MAX_READS} distances to solids"
    )]
    TooDense,
    /// The robot does not fit at the start.
    #[error(
        "`start` must be on ground to drive on with {radius} m of free ground all around, got ({x}, {y}) m"
    )]
    Start {
        /// The x coordinate of the start in metres.
        x: f64,
        /// The y coordinate of the start in metres.
        y: f64,
        /// The distance that the robot's centre must keep from solids, in metres.
        radius: f64,
    },
    /// The world has no start, and the robot does not fit anywhere.
    #[error("the world has no ground to drive on with {radius} m of free ground all around")]
    NoGround {
        /// The distance that the robot's centre must keep from solids, in metres.
        radius: f64,
    },
}
