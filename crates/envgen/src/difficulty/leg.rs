//! The motion of a robot from one scan to the next, and the effect of the ground on its odometry.

use glam::DVec2;

use crate::surface_index::{Ground, SurfaceIndex};
use crate::world::World;

/// The ground of a world, as far as it changes what wheels measure.
pub(super) struct Floor(Option<SurfaceIndex>);

impl Floor {
    pub(super) fn new(world: &World) -> Self {
        let plain = Ground::PLAIN;
        let is_uneven = world.surfaces.iter().map(Ground::from).any(|ground| {
            ground.odometry_noise != plain.odometry_noise || ground.wheel_bias != plain.wheel_bias
        });
        Floor(is_uneven.then(|| SurfaceIndex::new(world)))
    }

    fn at(&self, p: DVec2) -> Ground {
        self.0.as_ref().map_or(Ground::PLAIN, |surfaces| surfaces.at(p))
    }
}

/// The motion of a robot from one scan to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Leg {
    /// Distance in metres.
    pub(super) distance: f64,
    /// Turning in radians.
    pub(super) turning: f64,
    /// The integral over the distance of the excess over 1 of the ground's factor on the odometry's variances, in
    /// metres. Plain floor adds nothing, to the last bit.
    pub(super) slip_distance: f64,
    /// The same integral over the turning, in radians.
    pub(super) slip_turning: f64,
    /// The distance in metres by which the wheels measure too far.
    pub(super) wheel_bias: f64,
}

impl Leg {
    /// Adds the effect of the ground on a straight piece that ends at a point. [`Leg::distance`] is added
    /// separately, once for all pieces of a line, because their sum would be rounded.
    pub(super) fn roll(&mut self, floor: &Floor, to: DVec2, distance: f64) {
        let ground = floor.at(to);
        self.slip_distance += (ground.odometry_noise - 1.0) * distance;
        self.wheel_bias += ground.wheel_bias * distance;
    }

    /// Adds a turn on the spot at a point.
    pub(super) fn turn(&mut self, floor: &Floor, at: DVec2, turn: f64) {
        self.turning += turn;
        self.slip_turning += (floor.at(at).odometry_noise - 1.0) * turn;
    }
}
