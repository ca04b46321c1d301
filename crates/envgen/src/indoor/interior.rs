//! The free space inside a room: where a disc can be, which doorways are connected, and how wide the narrowest
//! passage is.
//!
//! The room is sampled at points at most [`STEP`] apart. A point counts as free if the disc has a clearance of half
//! a step to spare there, so that the disc can also move along the straight line between two free neighbours.
//! Points that are found connected are therefore really connected.

use glam::DVec2;

use super::catalogue::design::RoomDesign;
use super::dimensions::{Dimensions, STEP};
use super::grid::Side;
use super::room_placement::{DESIGN_UNIT, RoomPlacement};
use crate::geometry::{Rect, Shape};
use crate::grid::GridFrame;
use crate::union_find::UnionFind;

/// The greatest distance between two samples, in metres, for checks that must not overlook anything.
const FINE_STEP: f64 = 0.0125;

/// The greatest distance that is measured, in metres.
const REACH: f64 = 1.5;

/// Depth behind the wall's face, in metres, that is free of contents at every doorway in the profile `guaranteed`.
pub const DOORWAY_DEPTH: f64 = 0.5;

/// The free space inside a room, in the frame of the room's design (x right, y up) but in metres of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct Interior {
    parts: Vec<Part>,
    /// The ports of each side, at every half cell from the left or from the top, beginning at half a cell.
    ports: [Vec<Port>; 4],
}

/// A connected part of a room's free space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The point with the greatest clearance, in metres from the room's lower left corner.
    pub anchor: DVec2,
    /// Distance from the anchor to the nearest wall or part, in metres, at most 1.5.
    pub clearance: f64,
    /// Area of the positions where the footprint's centre can be, in square metres.
    pub area: f64,
}

/// A position in a room's side at which a doorway can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Port {
    /// The part of the free space to which a doorway at this position leads; `None` if contents block it.
    pub part: Option<u32>,
    /// Whether no contents are within a depth of [`DOORWAY_DEPTH`] behind the doorway.
    pub clear: bool,
}

impl Port {
    /// Returns whether a doorway is possible at this position: it leads somewhere, and no contents are right behind it.
    pub fn usable(self) -> bool {
        self.clear && self.part.is_some()
    }
}

impl Interior {
    /// Computes the free space of a room.
    ///
    /// # Panics
    /// When [`Dimensions::validate`] refuses the dimensions.
    pub fn new(room: &RoomDesign, dimensions: Dimensions) -> Interior {
        let field = Field::new(room, dimensions);
        let need = field.need();
        let (labels, parts) = field.label();
        let ports = Side::ALL.map(|side| {
            let length = room.side_length(side);
            (1..2 * length).map(|at| field.port(side, at, need, &labels)).collect()
        });
        Interior { parts, ports }
    }

    /// Returns the number of places in the room where the footprint has 2 cm to spare but which the samples did not
    /// find. They can lie between parts at any position.
    pub(super) fn overlooked(&self, room: &RoomDesign, dimensions: Dimensions) -> usize {
        let field = Field::sampled(room, dimensions, FINE_STEP, dimensions.radius + STEP);
        let (labels, parts) = field.label();
        let mut found = vec![false; parts.len()];
        for part in &self.parts {
            let at = (part.anchor / field.grid.cell_size).round();
            let label = labels[field.grid.index(at.x as usize, at.y as usize)];
            if let Some(found) = found.get_mut(label as usize) {
                *found = true;
            }
        }
        found.iter().filter(|found| !**found).count()
    }

    /// Returns the connected parts of the free space.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the port in a side of the unturned room, `at` half cells from its left or upper end. Outside the
    /// side, the port is blocked.
    pub fn port(&self, side: Side, at: u32) -> Port {
        let ports = &self.ports[side as usize];
        (at as usize).checked_sub(1).and_then(|i| ports.get(i)).copied().unwrap_or_default()
    }

    /// Returns the port in a side of the room after the room was turned by `quarters` quarter turns counter-clockwise.
    pub fn turned_port(&self, quarters: u8, side: Side, at: u32) -> Port {
        let length = |side: Side| self.ports[side as usize].len() as u32 + 1;
        let (original, at) = side.before_turn(at, quarters, length);
        self.port(original, at)
    }
}

/// Returns the width in metres of the narrowest point on the widest paths between the middles of all four sides, at
/// most 3; 0 if some side cannot be reached. It depends only on the room, not on its doorways, and is exact to
/// about a step of [`STEP`].
///
/// # Panics
/// As [`Interior::new`].
pub fn narrowest_passage(room: &RoomDesign, unit: f64, wall: f64, doorway: f64) -> f64 {
    let field = Field::new(room, Dimensions { unit, wall, doorway, radius: 0.0 });
    field.narrowest_passage(room, 0.5 * doorway)
}

/// Returns the room without the contents that block a doorway in a side, `at` half cells from its left or upper
/// end. These are the contents in the zone that must remain clear, or where the footprint enters.
pub(super) fn cleared(
    room: &RoomDesign,
    dimensions: Dimensions,
    side: Side,
    at: u32,
) -> RoomDesign {
    let field = Field::bare(room, dimensions, STEP, REACH);
    let need = field.need();
    let zone = doorway_zone(dimensions, field.size, side, at);
    let entry: Vec<DVec2> = field.entry_samples(side, at).map(|i| field.point(i)).collect();
    let frame = field.frame(room);
    let stays = |shape: &Shape| {
        let shape = frame.shape(shape);
        !overlaps(&shape, zone) && entry.iter().all(|&p| shape.distance(p) >= need)
    };
    let mut room = room.clone();
    room.walls.retain(|wall| stays(&wall.shape));
    room.obstacles.retain(|obstacle| stays(&obstacle.shape));
    room.surfaces.retain(|surface| !surface.is_barrier() || stays(&surface.shape));
    room
}

/// Returns the part of a room's floor that must remain clear at a doorway in a side, `at` half cells from its left
/// or upper end, in metres, for a room of the given size.
pub(super) fn doorway_zone(dimensions: Dimensions, size: DVec2, side: Side, at: u32) -> Rect {
    let depth = 0.5 * dimensions.wall + DOORWAY_DEPTH;
    let along = f64::from(at) * 0.5 * dimensions.unit;
    let half = 0.5 * dimensions.doorway;
    let (w, h) = (size.x, size.y);
    let (min, max) = match side {
        Side::North => ((along - half, h - depth), (along + half, h)),
        Side::South => ((along - half, 0.0), (along + half, depth)),
        Side::West => ((0.0, h - along - half), (depth, h - along + half)),
        Side::East => ((w - depth, h - along - half), (w, h - along + half)),
    };
    Rect::new(min.into(), max.into())
}

/// Sampled distances to the contents of a room.
struct Field {
    /// The grid of samples, which are the lower left corners of its cells.
    grid: GridFrame,
    size: DVec2,
    dimensions: Dimensions,
    /// Number of samples per side of a cell, which is even.
    per_cell: usize,
    barriers: Vec<Shape>,
    reach: f64,
    /// Distance to the nearest contents, at most `reach`, row by row from the lowest.
    contents: Vec<f64>,
}

impl Field {
    fn new(room: &RoomDesign, dimensions: Dimensions) -> Field {
        Field::sampled(room, dimensions, STEP, REACH)
    }

    /// Creates a field with samples at most `step` apart, and distances up to `reach`.
    fn sampled(room: &RoomDesign, dimensions: Dimensions, step: f64, reach: f64) -> Field {
        let mut field = Field::bare(room, dimensions, step, reach);
        let frame = field.frame(room);
        field.barriers = room.barriers().map(|shape| frame.shape(shape)).collect();
        for i in 0..field.barriers.len() {
            field.measure(i);
        }
        field
    }

    /// Creates a field of only the room's walls.
    fn bare(room: &RoomDesign, dimensions: Dimensions, step: f64, reach: f64) -> Field {
        if let Err(error) = dimensions.validate() {
            panic!("{error}");
        }
        let unit = dimensions.unit;
        // An even number, so that the middles of cells are samples.
        let per_cell = 2 * (0.5 * unit / step).ceil() as usize;
        let step = unit / per_cell as f64;
        let cols = per_cell * room.width as usize + 1;
        let rows = per_cell * room.height as usize + 1;
        let grid = GridFrame { origin: DVec2::ZERO, cell_size: step, cols, rows };
        Field {
            grid,
            size: DVec2::new(f64::from(room.width), f64::from(room.height)) * unit,
            dimensions,
            per_cell,
            barriers: Vec::new(),
            reach,
            contents: vec![reach; grid.len()],
        }
    }

    /// Returns the transform from the design of a room to metres of the map.
    fn frame(&self, room: &RoomDesign) -> RoomPlacement {
        let scale = self.dimensions.unit / DESIGN_UNIT;
        RoomPlacement { corner: DVec2::ZERO, scale, quarters: 0, size: room.size() }
    }

    /// Returns the clearance that the footprint's centre needs at a sample to be free.
    fn need(&self) -> f64 {
        self.dimensions.radius + 0.5 * self.grid.cell_size
    }

    fn measure(&mut self, barrier: usize) {
        let shape = &self.barriers[barrier];
        let around = shape.bounds().grown(self.reach);
        let low = |x: f64| (x / self.grid.cell_size).ceil().max(0.0) as usize;
        let high = |x: f64, n: usize| {
            ((x / self.grid.cell_size).floor().max(-1.0) + 1.0).min(n as f64) as usize
        };
        let columns = low(around.min.x)..high(around.max.x, self.grid.cols);
        for row in low(around.min.y)..high(around.max.y, self.grid.rows) {
            for column in columns.clone() {
                let p = self.grid.corner(column, row);
                let distance = &mut self.contents[self.grid.index(column, row)];
                *distance = distance.min(shape.distance(p));
            }
        }
    }

    fn point(&self, i: usize) -> DVec2 {
        let (column, row) = self.grid.cell(i);
        self.grid.corner(column, row)
    }

    /// Returns the distance from a sample to the nearest face of the room's four walls, negative inside a wall.
    fn to_wall(&self, i: usize) -> f64 {
        let p = self.point(i);
        p.min(self.size - p).min_element() - 0.5 * self.dimensions.wall
    }

    /// Numbers the connected parts of the samples where the footprint's centre can be.
    fn label(&self) -> (Vec<u32>, Vec<Part>) {
        let need = self.need();
        let is_free = |i: usize| self.contents[i] >= need && self.to_wall(i) >= need;
        let free: Vec<bool> = (0..self.contents.len()).map(is_free).collect();
        let mut labels = vec![u32::MAX; free.len()];
        let mut parts = Vec::new();
        let mut stack = Vec::new();
        for first in 0..free.len() {
            if !free[first] || labels[first] != u32::MAX {
                continue;
            }
            let label = parts.len() as u32;
            let (mut best, mut clearance, mut count) = (first, 0.0, 0_u32);
            labels[first] = label;
            stack.push(first);
            while let Some(i) = stack.pop() {
                count += 1;
                let here = self.contents[i].min(self.to_wall(i));
                if here > clearance {
                    (best, clearance) = (i, here);
                }
                for j in self.grid.neighbours(i) {
                    if free[j] && labels[j] == u32::MAX {
                        labels[j] = label;
                        stack.push(j);
                    }
                }
            }
            let area = f64::from(count) * self.grid.cell_size * self.grid.cell_size;
            parts.push(Part { anchor: self.point(best), clearance, area });
        }
        (labels, parts)
    }

    /// Returns the sample `depth` steps behind the wall's centre line, `at` half cells along a side.
    fn behind(&self, side: Side, at: u32, depth: usize) -> usize {
        let GridFrame { cols, rows, .. } = self.grid;
        let along = at as usize * self.per_cell / 2;
        let (column, row) = match side {
            Side::North => (along, rows - 1 - depth),
            Side::South => (along, depth),
            Side::West => (depth, rows - 1 - along),
            Side::East => (cols - 1 - depth, rows - 1 - along),
        };
        self.grid.index(column, row)
    }

    /// Returns the samples from a wall's centre line inward until the footprint is past the wall.
    fn entry_samples(&self, side: Side, at: u32) -> impl Iterator<Item = usize> + use<'_> {
        let deepest =
            ((0.5 * self.dimensions.wall + self.need()) / self.grid.cell_size).ceil() as usize + 1;
        let last = deepest.min(self.grid.cols.min(self.grid.rows) - 1);
        (0..=last).map(move |depth| self.behind(side, at, depth))
    }

    fn port(&self, side: Side, at: u32, need: f64, labels: &[u32]) -> Port {
        let zone = doorway_zone(self.dimensions, self.size, side, at);
        let clear = !self.barriers.iter().any(|shape| overlaps(shape, zone));
        let mut part = None;
        for i in self.entry_samples(side, at) {
            if self.contents[i] < need {
                break;
            }
            if labels[i] != u32::MAX {
                part = Some(labels[i]);
                break;
            }
        }
        Port { part, clear }
    }

    /// Joins samples in the order of falling clearance until the middles of all sides are connected.
    fn narrowest_passage(&self, room: &RoomDesign, half_doorway: f64) -> f64 {
        let clearance: Vec<f64> = (0..self.contents.len())
            .map(|i| {
                // In the strip behind a doorway the wall next to it does not count.
                let p = (self.point(i) - 0.5 * self.size).abs();
                let wall = 0.5 * self.size - p - 0.5 * self.dimensions.wall;
                let x = if p.y <= half_doorway { REACH } else { wall.x };
                let y = if p.x <= half_doorway { REACH } else { wall.y };
                self.contents[i].min(x).min(y).max(0.0)
            })
            .collect();
        let mut order: Vec<u32> = (0..clearance.len() as u32).collect();
        order.sort_by(|&a, &b| clearance[b as usize].total_cmp(&clearance[a as usize]));
        let entries = Side::ALL.map(|side| self.behind(side, room.side_length(side), 0));
        let mut sets = UnionFind::new(clearance.len());
        let mut joined = vec![false; clearance.len()];
        for i in order {
            let i = i as usize;
            if clearance[i] <= 0.0 {
                return 0.0;
            }
            joined[i] = true;
            for j in self.grid.neighbours(i).filter(|&j| joined[j]) {
                sets.join(i, j);
            }
            let met = entries
                .iter()
                .all(|&entry| joined[entry] && sets.find(entry) == sets.find(entries[0]));
            if met {
                return 2.0 * clearance[i];
            }
        }
        0.0
    }
}

/// Whether a convex shape and a rectangle have more than a border in common.
fn overlaps(shape: &Shape, rect: Rect) -> bool {
    const TOUCH: f64 = 1e-9;
    let rect = rect.grown(-TOUCH);
    match shape {
        Shape::Disc { center, radius } => {
            let nearest = center.clamp(rect.min, rect.max);
            nearest.distance(*center) < *radius
        }
        Shape::Segment { .. } | Shape::Box { .. } | Shape::Polygon { .. } => {
            // Separating axes: those of the rectangle, then the normals of the shape.
            let corners = shape.corners();
            let bounds = shape.bounds();
            let around = Shape::from_rect(rect).corners();
            bounds.overlaps(rect)
                && crate::geometry::edges(&corners)
                    .all(|(a, b)| around.iter().any(|&p| (b - a).perp_dot(p - a) > 0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::OnceLock;

    use super::*;
    use crate::indoor::catalogue::Catalogue;
    use crate::world::{Obstacle, ObstacleKind, Surface, SurfaceKind};
    use proptest::prelude::*;

    const ROBOT: Dimensions = Dimensions { unit: 3.0, wall: 0.1, doorway: 0.94, radius: 0.36 };

    fn room(shapes: &[Shape]) -> RoomDesign {
        let mut room = RoomDesign::bare("test", 2, 1, 5.0);
        room.obstacles.extend(shapes.iter().map(|s| Obstacle::new(ObstacleKind::Other, s.clone())));
        room
    }

    fn block(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
        Shape::from_rect(Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1)))
    }

    #[test]
    fn an_empty_room_is_one_part_with_a_port_everywhere() {
        let interior = Interior::new(&room(&[]), ROBOT);
        assert_eq!(interior.parts().len(), 1);
        let part = interior.parts()[0];
        assert!((part.clearance - 1.45).abs() < 1e-9, "{part:?}");
        // The middle can be 0.435 m from the walls' lines, on a sample.
        let (width, height): (f64, f64) = (6.0 - 0.9 + 0.05, 3.0 - 0.9 + 0.05);
        assert!((part.area - width * height).abs() < 1e-9, "{}", part.area);
        for (side, count) in [(Side::North, 3), (Side::East, 1), (Side::South, 3), (Side::West, 1)]
        {
            assert!((1..=count).all(|at| interior.port(side, at).usable()));
            assert!(!interior.port(side, 0).usable() && !interior.port(side, count + 1).usable());
        }
    }

    #[test]
    fn a_wall_to_wall_shelf_makes_two_parts() {
        let interior = Interior::new(&room(&[block(2.8, 0.0, 3.2, 3.0)]), ROBOT);
        assert_eq!(interior.parts().len(), 2);
        let west = interior.port(Side::West, 1);
        let east = interior.port(Side::East, 1);
        assert!(west.usable() && east.usable() && west.part != east.part);
        assert_eq!(interior.port(Side::North, 1).part, west.part);
        assert_eq!(interior.port(Side::South, 3).part, east.part);
        assert_eq!(interior.port(Side::North, 2), Port { part: None, clear: false });
        let gap = |width: f64| {
            let shelf = block(2.8, 0.05 + width, 3.2, 2.2);
            let wall = block(2.8, 2.2, 3.2, 3.0);
            Interior::new(&room(&[shelf, wall]), ROBOT).parts().len()
        };
        assert_eq!((gap(0.7), gap(0.85)), (2, 1));
    }

    #[test]
    fn water_makes_two_parts_whatever_its_speed() {
        for speed in [0.0, 0.5, 1.0] {
            let mut design = room(&[]);
            let water = Surface::new(SurfaceKind::Water, block(2.8, 0.0, 3.2, 3.0));
            design.surfaces.push(Surface { speed, ..water });
            assert_eq!(Interior::new(&design, ROBOT).parts().len(), 2, "{speed}");
        }
    }

    #[test]
    fn the_narrowest_passage_is_measured() {
        // North lies in the middle of the long side: the path west passes the shelf.
        for width in [0.4, 0.6, 0.9, 1.2] {
            let room = room(&[block(1.6, 0.05 + width, 2.0, 2.95)]);
            let measured = narrowest_passage(&room, 3.0, 0.1, 0.94);
            assert!((measured - width).abs() <= 2.0 * STEP, "{width}: {measured}");
        }
        assert_eq!(narrowest_passage(&room(&[block(1.6, 0.0, 2.0, 3.0)]), 3.0, 0.1, 0.94), 0.0);
    }

    #[test]
    fn turned_ports_are_those_of_the_turned_room() {
        // A room without symmetry, turned by hand through its own frame.
        let design = room(&[block(0.2, 0.2, 0.7, 0.7), block(3.0, 2.5, 6.0, 3.0)]);
        let interior = Interior::new(&design, ROBOT);
        for quarters in 0..4_u8 {
            let mut turned = RoomDesign::bare("turned", 2, 1, 5.0);
            if quarters % 2 == 1 {
                (turned.width, turned.height) = (1, 2);
            }
            let corner = DVec2::ZERO;
            let frame = RoomPlacement { corner, scale: 1.0, quarters, size: design.size() };
            turned.obstacles = design.obstacles.clone();
            for obstacle in &mut turned.obstacles {
                obstacle.shape = frame.shape(&obstacle.shape);
            }
            let by_hand = Interior::new(&turned, ROBOT);
            for side in Side::ALL {
                for at in 0..=4 {
                    let (a, b) = (interior.turned_port(quarters, side, at), by_hand.port(side, at));
                    assert_eq!(a.usable(), b.usable(), "{quarters} {side:?} {at}");
                    assert_eq!(a.clear, b.clear);
                }
            }
        }
    }

    #[test]
    fn only_what_blocks_a_doorway_goes() {
        // The zone is 1.03 to 1.97 m from the left, and 0.55 m deep.
        let (zone, ahead) = (block(0.9, 0.3, 1.2, 0.5), block(1.4, 0.7, 1.6, 0.8));
        let (beside, behind) = (block(2.0, 0.1, 2.2, 0.3), block(1.4, 1.0, 1.6, 1.2));
        let stays = |shape: &Shape| {
            let cleared = cleared(&room(std::slice::from_ref(shape)), ROBOT, Side::South, 1);
            cleared.obstacles.len() == 1
        };
        assert_eq!([&zone, &ahead, &beside, &behind].map(stays), [false, false, true, true]);
        let port = |room: &RoomDesign| Interior::new(room, ROBOT).port(Side::South, 1);
        let shelves = room(&[zone, block(1.0, 0.4, 5.0, 0.6)]);
        assert!(!port(&shelves).usable());
        assert!(port(&cleared(&shelves, ROBOT, Side::South, 1)).usable());
    }

    proptest! {
        #[test]
        fn a_cleared_doorway_can_be_used(
            which in 0..20_usize, side in 0..4_usize, place: u32, radius in 0.1..0.4_f64,
        ) {
            let room = &Catalogue::builtin().rooms()[which];
            let dimensions = Dimensions { radius, ..ROBOT };
            let side = Side::ALL[side];
            let at = 1 + place % (2 * room.side_length(side) - 1);
            let cleared = cleared(room, dimensions, side, at);
            prop_assert!(Interior::new(&cleared, dimensions).port(side, at).usable());
            prop_assert_eq!(cleared.validate(), Ok(()));
        }

        #[test]
        fn overlap_is_what_points_say(
            x in -1.0..2.0_f64, y in -1.0..2.0_f64, heading in -3.0..3.0_f64, disc: bool,
        ) {
            let rect = Rect::new(DVec2::ZERO, DVec2::new(1.0, 0.5));
            let center = DVec2::new(x, y);
            let shape = if disc {
                Shape::Disc { center, radius: 0.4 }
            } else {
                Shape::Box { center, half_size: DVec2::new(0.5, 0.1), heading }
            };
            let touches = (0..=100).any(|i| (0..=50).any(|j| {
                shape.contains(DVec2::new(f64::from(i), f64::from(j)) * 0.01)
            }));
            let near = (0..=100).any(|i| (0..=50).any(|j| {
                shape.distance(DVec2::new(f64::from(i), f64::from(j)) * 0.01) < 0.008
            }));
            let overlap = overlaps(&shape, rect);
            prop_assert!(!touches || overlap || !near);
            prop_assert!(!overlap || near);
        }

        #[test]
        fn a_smaller_robot_reaches_no_less(radius in 0.1..0.36_f64) {
            let areas = |radius: f64| -> Vec<f64> {
                let rooms = Catalogue::builtin().rooms().iter().filter(|room| room.width < 4);
                let interiors =
                    rooms.map(|room| Interior::new(room, Dimensions { radius, ..ROBOT }));
                interiors.map(|it| it.parts().iter().map(|part| part.area).sum()).collect()
            };
            static LARGE: OnceLock<Vec<f64>> = OnceLock::new();
            let large = LARGE.get_or_init(|| areas(ROBOT.radius));
            for (small, large) in areas(radius).into_iter().zip(large) {
                prop_assert!(small >= *large);
            }
        }
    }
}
