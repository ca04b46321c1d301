//! References, against which maps are scored.

use std::ops::Deref;

use envgen::Seed;
use envgen::world::World;
use glam::DVec2;

use super::navigability::{Trip, trips};
use super::walls::true_runs;
use crate::mappable_area::{MappableArea, MappableAreaError};
use crate::robot::Robot;

/// A mappable area with data on its perfect map, computed once for any number of trials in its world.
#[derive(Clone, Debug)]
pub struct Reference {
    area: MappableArea,
    runs: Vec<u8>,
    trips: Vec<Trip>,
}

impl Reference {
    /// Computes the reference from the world's start.
    ///
    /// # Errors
    ///
    /// As [`MappableArea::new`].
    pub fn new(world: &World, robot: &Robot) -> Result<Self, MappableAreaError> {
        Ok(Reference::of(MappableArea::new(world, robot)?, world))
    }

    /// Computes the reference from a start, which may be the world's or another one.
    ///
    /// # Errors
    ///
    /// As [`MappableArea::from_start`].
    pub fn from_start(
        world: &World,
        robot: &Robot,
        start: DVec2,
    ) -> Result<Self, MappableAreaError> {
        Ok(Reference::of(MappableArea::from_start(world, robot, start)?, world))
    }

    fn of(area: MappableArea, world: &World) -> Self {
        let map = area.perfect_map();
        let runs = true_runs(&area, &map);
        let trips = trips(&area, &map, world.provenance.seed.unwrap_or(Seed(0)));
        Reference { area, runs, trips }
    }

    /// For each wall point, the number of walls that a search along its normal crosses.
    pub(super) fn runs(&self) -> &[u8] {
        &self.runs
    }

    /// The trips by which the navigability of a map is tested.
    pub(super) fn trips(&self) -> &[Trip] {
        &self.trips
    }
}

impl Deref for Reference {
    type Target = MappableArea;

    fn deref(&self) -> &MappableArea {
        &self.area
    }
}
