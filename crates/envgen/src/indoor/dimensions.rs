//! The dimensions that decide where a robot can go.

use crate::error::SpecError;
use crate::settings::Setting;

/// Greatest distance between two samples, in metres.
pub const STEP: f64 = 0.05;

pub(super) const UNIT: Setting = Setting::number("unit", "m", 1.2, 12.0, "side of a cell");
pub(super) const WALL: Setting = Setting::number("wall", "m", 0.01, 0.5, "thickness of the walls");
pub(super) const DOORWAY: Setting =
    Setting::number("doorway", "m", 0.2, 3.0, "width of a doorway, at most a cell less two walls");
pub(super) const FOOTPRINT: Setting = Setting::number(
    "footprint",
    "m",
    0.01,
    1.4,
    "radius of the robot that must reach every place, at most half a doorway less 0.05 m",
);

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

impl Dimensions {
    /// Checks the dimensions against the limits of the settings of an
    /// [`IndoorSpec`](super::IndoorSpec); a radius may be 0.
    ///
    /// # Errors
    /// The first dimension that is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        UNIT.check(self.unit)?;
        WALL.check(self.wall)?;
        DOORWAY.check(self.doorway)?;
        if self.radius == 0.0 { Ok(()) } else { FOOTPRINT.check(self.radius) }
    }
}
