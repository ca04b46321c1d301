//! What a map is scored against.

use std::ops::Deref;

use envgen::Seed;
use envgen::world::World;
use glam::DVec2;

use super::navigability::{Trip, trips};
use super::walls::true_runs;
use crate::mappable_area::{MappableArea, MappableAreaError};
use crate::robot::Robot;

/// The mappable area of a world with what its perfect map gives, computed once for any number of
/// trials in it.
#[derive(Clone, Debug)]
pub struct Reference {
    area: MappableArea,
    runs: Vec<u8>,
    trips: Vec<Trip>,
}

impl Reference {
    /// The reference from the world's start.
    ///
    /// # Errors
    /// As [`MappableArea::new`].
    pub fn new(world: &World, robot: &Robot) -> Result<Self, MappableAreaError> {
        Ok(Reference::of(MappableArea::new(world, robot)?, world))
    }

    /// The reference from a start, the world's or another one.
    ///
    /// # Errors
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

    /// How many walls a search along each wall point's normal crosses.
    pub(super) fn runs(&self) -> &[u8] {
        &self.runs
    }

    /// The trips with which the navigability of a map is tested.
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
