//! The dimensions that decide where a robot can go.

/// Greatest distance between two samples, in metres.
pub const STEP: f64 = 0.05;

/// The dimensions that decide where a robot can go, all in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Side of a cell.
    pub unit: f64,
    /// Thickness of the walls.
    pub wall: f64,
    /// Width of a doorway.
    pub doorway: f64,
    /// Radius of the robot's footprint.
    pub radius: f64,
}
