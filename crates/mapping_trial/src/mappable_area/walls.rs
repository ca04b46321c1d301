//! The walls that can be seen from where a robot can be.

use std::f64::consts::{PI, TAU};

use envgen::World;
use envgen::geometry::{Pose, Shape, edges, unit_vector};
use envgen::raycast::{Raycaster, ScanPattern};
use glam::DVec2;

use super::frame::{SCORE_CELL, ScoreFrame};

/// Greatest distance between neighbouring points of an outline in metres: a cell of a map.
const SPACING: f64 = 0.05;

/// Distance in metres from an outline at which a point looks for free space.
const LIFT: f64 = 0.01;

/// Distance in metres up to which walls are seen: the range of the laser profile with the longest.
const SIGHT: f64 = 20.0;

/// Number of directions in which a point looks for free space that is not right in front of it.
const LOOKS: usize = 64;

/// A point on the outline of a wall. Each point represents about the same length of wall.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::{robot::Robot, mappable_area::MappableArea};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let area = MappableArea::new(&world, &Robot::default())?;
/// // Normals point to the side that the robot sees, away from the wall.
/// for wall in area.walls() {
///     assert!((wall.normal.length() - 1.0).abs() < 1e-9);
///     assert!(world.clearance(wall.position + 0.05 * wall.normal) > 0.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPoint {
    /// Position in metres, in the world's frame.
    pub position: DVec2,
    /// Unit vector that points out of the wall, to the side from which it is seen.
    pub normal: DVec2,
}

/// Returns the points of outlines that a laser at a height can see from the cells of `free`, in the
/// world's order. `joined` are the cells that no solid enters and that are connected to `free`.
pub(super) fn seen(
    world: &World,
    laser: f64,
    frame: ScoreFrame,
    free: &[bool],
    joined: &[bool],
) -> Vec<WallPoint> {
    let Ok(fan) = ScanPattern::new(PI, LOOKS) else { unreachable!("a half turn of {LOOKS} looks") };
    let sight = Sight { rays: Raycaster::at_height(world, laser), fan, frame, free, joined };
    let mut points = Vec::new();
    let mut ranges = Vec::new();
    for solid in world.solids_at(laser) {
        outline(&solid.shape, |candidates| {
            points.extend(candidates.iter().find(|point| sight.has(**point, &mut ranges)));
        });
    }
    points
}

struct Sight<'a> {
    rays: Raycaster,
    fan: ScanPattern,
    frame: ScoreFrame,
    free: &'a [bool],
    joined: &'a [bool],
}

impl Sight<'_> {
    /// Whether free space can be seen from a point.
    fn has(&self, point: WallPoint, ranges: &mut Vec<f64>) -> bool {
        let before = point.position + point.normal * SCORE_CELL;
        let Some(cell) = self.frame.cell_at(before) else { return false };
        let beside = (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y)));
        let beside = || beside.clone().filter_map(|(x, y)| self.frame.neighbour(cell, x, y));
        if !beside().any(|cell| self.joined[cell]) {
            return false;
        }
        let eye = point.position + point.normal * LIFT;
        // Most walls have free space right in front of them.
        if beside().any(|cell| self.free[cell] && self.open_between(eye, cell)) {
            return true;
        }
        let heading = libm::atan2(point.normal.y, point.normal.x);
        self.rays.scan(Pose { position: eye, heading }, &self.fan, SIGHT, ranges);
        ranges.iter().enumerate().any(|(i, &range)| {
            let direction = unit_vector(heading + PI * (i as f64 / (LOOKS - 1) as f64 - 0.5));
            let steps = (range / SCORE_CELL) as usize;
            (1..=steps).any(|step| {
                let p = eye + direction * (step as f64 * SCORE_CELL);
                self.frame.cell_at(p).is_some_and(|cell| self.free[cell])
            })
        })
    }

    /// Whether there is no solid between a point and the centre of a cell.
    fn open_between(&self, eye: DVec2, cell: usize) -> bool {
        let offset = self.frame.centre(cell) - eye;
        let length = offset.length();
        length > 0.0 && self.rays.cast_along(eye, offset / length, length).is_none()
    }
}

/// Visits points along a shape's outline, each with the directions from which it may be seen: one for a
/// filled shape, both for a line.
fn outline(shape: &Shape, mut visit: impl FnMut(&[WallPoint])) {
    let mut side = |a: DVec2, b: DVec2, both: bool| {
        let count = ((b - a).length() / SPACING).ceil().max(1.0);
        let normal = -(b - a).normalize_or_zero().perp();
        for i in 0..count as usize {
            let position = a + (b - a) * ((i as f64 + 0.5) / count);
            let (this, that) =
                (WallPoint { position, normal }, WallPoint { position, normal: -normal });
            visit(&[this, that][..if both { 2 } else { 1 }]);
        }
    };
    match shape {
        Shape::Segment { a, b } => side(*a, *b, true),
        // Outlines are counter-clockwise, so that their outside is on the right.
        Shape::Box { .. } | Shape::Polygon { .. } => {
            edges(&shape.corners()).for_each(|(a, b)| side(a, b, false));
        }
        Shape::Disc { center, radius } => {
            let count = (TAU * radius / SPACING).ceil().max(8.0);
            for i in 0..count as usize {
                let normal = unit_vector(TAU * (i as f64 / count));
                visit(&[WallPoint { position: *center + normal * *radius, normal }]);
            }
        }
    }
}
