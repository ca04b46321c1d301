//! What people walk among.

use glam::DVec2;

use super::free_space::FreeSpace;
use super::routes::Routes;
use crate::grid::CellBuckets;
use crate::raycast::Raycaster;
use crate::scenario::ScenarioSpec;
use crate::scenario::doors::{DoorShape, DoorState};
use crate::scenario::person::Person;
use crate::scenario::robot::Robot;
use crate::seed::Seed;

/// What people walk among.
pub(crate) struct Surroundings<'a> {
    pub(crate) space: &'a FreeSpace,
    pub(crate) routes: &'a Routes,
    pub(crate) rays: &'a Raycaster,
    pub(crate) shapes: &'a [DoorShape],
    /// The doors near each cell of the free space.
    pub(crate) door_zones: &'a CellBuckets<u32>,
    /// The same for a point to which someone can go before the lists of neighbours are rebuilt.
    pub(crate) near_doors: &'a CellBuckets<u32>,
    pub(crate) people: &'a [Person],
    pub(crate) spec: &'a ScenarioSpec,
    pub(crate) seed: Seed,
    pub(crate) doors: &'a [DoorState],
    pub(crate) robots: &'a [Robot],
    pub(crate) tick: u64,
    /// The greatest speed of anyone, in m/s.
    pub(crate) max_speed: f64,
}

impl Surroundings<'_> {
    /// The doors of a cell at a point.
    #[inline]
    pub(super) fn at<'a>(&self, doors: &'a CellBuckets<u32>, p: DVec2) -> &'a [u32] {
        if self.shapes.is_empty() {
            return &[];
        }
        self.space.frame.index_at(p).map_or(&[], |cell| doors.of(cell))
    }
}

/// Whether no solid is between a point and another one at `to` from it.
pub(super) fn sees(rays: &Raycaster, from: DVec2, to: DVec2) -> bool {
    let distance = to.length();
    distance == 0.0 || rays.cast_along(from, to / distance, distance).is_none()
}

/// The robot nearest to a point, of equally near ones the first; one that is infinitely far without any.
pub(super) fn nearest_robot(p: DVec2, robots: &[Robot]) -> Robot {
    let far = Robot { position: DVec2::INFINITY, velocity: DVec2::ZERO, radius: 0.0 };
    robots.iter().fold(far, |best, robot| {
        let is_nearer = robot.position.distance_squared(p) < best.position.distance_squared(p);
        if is_nearer { *robot } else { best }
    })
}
