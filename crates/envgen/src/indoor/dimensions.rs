//! The dimensions that determine where a robot can go.

/// The greatest distance between two samples, in metres.
pub const STEP: f64 = 0.05;

/// The dimensions that determine where a robot can go, all in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Side of a cell of the grid.
    pub unit: f64,
    /// Thickness of the walls.
    pub wall: f64,
    /// Width of a doorway.
    pub doorway: f64,
    /// Radius of the robot's footprint.
    pub radius: f64,
}
