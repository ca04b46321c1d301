//! Robots, as a scenario sees them.

use glam::DVec2;

use crate::error::SpecError;

/// A robot, as people and doors sense it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robot {
    /// True position in metres.
    pub position: DVec2,
    /// True velocity in m/s.
    pub velocity: DVec2,
    /// Radius in metres of a disc that contains the robot.
    pub radius: f64,
}

impl Robot {
    pub(super) fn check(&self) -> Result<(), SpecError> {
        for (name, value) in [("position", self.position), ("velocity", self.velocity)] {
            if !value.is_finite() {
                return Err(SpecError::new(name, value, "finite numbers"));
            }
        }
        if !(0.0..1e6).contains(&self.radius) {
            return Err(SpecError::new("radius", self.radius, "a number from 0 to 1e6"));
        }
        Ok(())
    }
}
