//! The directions of laser scans.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::error::SpecError;
use crate::geometry::unit_vector;

/// The most rays of a scan pattern.
const MAX_BEAMS: usize = 1_000_000;

/// The directions of a laser scan, relative to the scanner.
///
/// ```
/// use envgen::raycast::{Raycaster, ScanPattern};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// // A scanner that sees all around, with a beam every 2 degrees.
/// let pattern = ScanPattern::new(std::f64::consts::TAU, 181)?;
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// let start = world.start.expect("a forest with a free place");
/// let mut ranges = Vec::new();
/// Raycaster::new(&world).scan(start, &pattern, 20.0, &mut ranges);
/// assert_eq!(ranges.len(), pattern.len());
/// assert!(ranges.iter().all(|range| (0.0..=20.0).contains(range)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ScanPattern {
    directions: Vec<DVec2>,
}

impl ScanPattern {
    /// Creates a pattern of `beams` rays that are spread evenly over `field_of_view` radians, centred on the
    /// scanner's heading, from right to left, with a ray at both ends. The field of view is from 0 to 2 pi; there
    /// are at most a million beams.
    ///
    /// # Errors
    /// Names the first of the two that is out of range.
    pub fn new(field_of_view: f64, beams: usize) -> Result<Self, SpecError> {
        if !(0.0..=TAU).contains(&field_of_view) {
            let allowed = format!("a number from 0 to {TAU}");
            return Err(SpecError::new("field_of_view", field_of_view, allowed));
        }
        if beams > MAX_BEAMS {
            let allowed = format!("a whole number from 0 to {MAX_BEAMS}");
            return Err(SpecError::new("beams", beams, allowed));
        }
        let step = field_of_view / beams.saturating_sub(1).max(1) as f64;
        let first = if beams > 1 { -0.5 * field_of_view } else { 0.0 };
        let directions = (0..beams).map(|i| unit_vector(first + step * i as f64)).collect();
        Ok(ScanPattern { directions })
    }

    /// Returns the unit vectors of the rays, from right to left, relative to the scanner's heading.
    ///
    /// ```
    /// use envgen::glam::DVec2;
    /// use envgen::raycast::ScanPattern;
    ///
    /// // Three beams over half a turn: right, ahead, left.
    /// let pattern = ScanPattern::new(std::f64::consts::PI, 3)?;
    /// let expected = [DVec2::NEG_Y, DVec2::X, DVec2::Y];
    /// for (direction, expected) in pattern.directions().iter().zip(expected) {
    ///     assert!(direction.distance(expected) < 1e-12);
    /// }
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    pub fn directions(&self) -> &[DVec2] {
        &self.directions
    }

    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Returns whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }
}
