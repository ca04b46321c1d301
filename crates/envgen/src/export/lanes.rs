//! Lanes: sequences of straight lines between places, along which a round robot is free.

use glam::DVec2;

use crate::cellular::CheapestPaths;
use crate::clearance_index::ClearanceIndex;
use crate::geometry::{Shape, edges};
use crate::grid::GridFrame;
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::surface_index::{Ground, SurfaceIndex};
use crate::world::{Obstacle, ObstacleKind, World};

/// Radius in metres of the robot for which lanes must be free.
const ROBOT_RADIUS: f64 = 0.3;

/// Side in metres of a cell of the grid on which lanes are searched, unless the world is large.
const CELL: f64 = 0.1;

/// Approximate greatest number of cells of that grid.
const MOST_CELLS: f64 = 4e6;

/// The distance in metres by which the index of clearances exceeds what is needed, so that lines can be looked up
/// in longer pieces.
const BEYOND: f64 = 1.0;

/// Number of cells to each side in which a lane may begin or end.
const AROUND: isize = 2;

/// The sides of polygons with more corners than this are indexed one by one, because a query reads whole shapes.
const MOST_CORNERS: usize = 64;

/// The lanes from a start.
pub(super) struct Lanes {
    ground: FreeGround,
    start: DVec2,
    paths: CheapestPaths,
}

/// The ground on which the robot can be.
struct FreeGround {
    frame: GridFrame,
    solids: ClearanceIndex,
    surfaces: SurfaceIndex,
}

impl Lanes {
    /// Finds the lanes from a start; `None` if the robot does not fit there.
    pub(super) fn from(world: &World, start: DVec2) -> Option<Self> {
        let size = world.bounds.size();
        let least = (size.x * size.y / MOST_CELLS).sqrt().max(size.max_element() / MOST_CELLS);
        let side = CELL.max(least);
        let count = (size / side).ceil().max(DVec2::ONE);
        let (cols, rows) = (count.x as usize, count.y as usize);
        let frame = GridFrame { origin: world.bounds.min, cell_size: side, cols, rows };
        // So much room around the middles of two neighbours keeps the line between them free.
        let room = (ROBOT_RADIUS * ROBOT_RADIUS + 0.5 * side * side).sqrt();
        let large = Large::of(world, frame);
        let solids = large.as_ref().map_or(world, |large| &large.outlines);
        let solids = ClearanceIndex::new(solids, room + BEYOND).ok()?;
        let is_inside =
            |cell: usize| large.as_ref().is_some_and(|large| large.inside.cells()[cell]);
        let ground =
            FreeGround { frame, solids, surfaces: SurfaceIndex::of(world, Ground::is_barrier) };
        let is_firm_everywhere = ground.surfaces.is_plain();
        // Halves of the lines to all neighbours.
        let arms =
            [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(1.0, -1.0)].map(|to| 0.5 * side * to);
        let is_blocked = |cell: usize| {
            let p = frame.center_of(cell);
            let is_barred = |&arm: &DVec2| ground.surfaces.barrier_along(p - arm, p + arm).0;
            ground.solids.clearance(p) < room
                || is_inside(cell)
                || (!is_firm_everywhere && arms.iter().any(is_barred))
        };
        let blocked: Vec<bool> = (0..frame.len()).map(is_blocked).collect();
        let first = ground.cell_near(start, |cell| !blocked[cell])?;
        let paths = CheapestPaths::new(cols, &blocked, side, first, None);
        Some(Lanes { ground, start, paths })
    }

    /// Returns the point of an area to which a lane can lead and which is nearest to another point.
    pub(super) fn nearest_in(&self, area: &Shape, to: DVec2) -> Option<DVec2> {
        if area.contains(to) && self.end(to).is_some() {
            return Some(to);
        }
        let (frame, bounds) = (self.ground.frame, area.bounds());
        let [low, high] = [bounds.min, bounds.max].map(|corner| {
            let cell = ((corner - frame.origin) / frame.cell_size).max(DVec2::ZERO);
            (cell.x as usize, cell.y as usize)
        });
        let (cols, rows) = (low.0..=high.0.min(frame.cols - 1), low.1..=high.1.min(frame.rows - 1));
        let cells = rows.flat_map(|row| cols.clone().map(move |col| (col, row)));
        cells
            .filter(|&(col, row)| self.paths.reaches(frame.index(col, row)))
            .map(|(col, row)| frame.center(col, row))
            .filter(|&p| area.contains(p))
            .min_by(|a, b| a.distance_squared(to).total_cmp(&b.distance_squared(to)))
    }

    /// Returns the points at which the lane to a goal turns, without its ends; `None` if there are no lanes to it.
    pub(super) fn turns(&self, goal: DVec2) -> Option<Vec<DVec2>> {
        let cells = self.paths.to(self.end(goal)?)?;
        let cells = cells.iter().map(|&cell| self.ground.frame.center_of(cell));
        let points: Vec<DVec2> = [self.start].into_iter().chain(cells).chain([goal]).collect();
        let (mut turns, mut at) = (Vec::new(), 0);
        while at + 1 < points.len() {
            at = self.farthest_seen(&points, at);
            turns.push(points[at]);
        }
        turns.pop();
        Some(turns)
    }

    /// Returns the index of a point far along a path that is visible from another point. The steps of the search
    /// grow as long as they end at visible points.
    fn farthest_seen(&self, points: &[DVec2], at: usize) -> usize {
        let last = points.len() - 1;
        let (mut seen, mut step, mut grows) = (at + 1, 1, true);
        while step > 0 && seen < last {
            let next = (seen + step).min(last);
            let is_seen = self.ground.is_free_along(points[at], points[next]);
            if is_seen {
                seen = next;
            }
            grows &= is_seen;
            step = if grows { 2 * step } else { step / 2 };
        }
        seen
    }

    /// Returns the cell at which the lane to a point ends.
    fn end(&self, goal: DVec2) -> Option<usize> {
        self.ground.cell_near(goal, |cell| self.paths.reaches(cell))
    }
}

/// The solids of a world with polygons of very many corners.
struct Large {
    /// The solids, with the sides of these polygons in their place. A line between a point outside of a polygon and
    /// one inside meets a side.
    outlines: World,
    /// The cells whose middles these polygons cover.
    inside: OccupancyGrid,
}

impl Large {
    /// Returns the solids of a world; `None` if no polygon has very many corners.
    fn of(world: &World, frame: GridFrame) -> Option<Self> {
        let is_large = |shape: &Shape| matches!(shape, Shape::Polygon { vertices } if vertices.len() > MOST_CORNERS);
        if !world.solids().any(|solid| is_large(&solid.shape)) {
            return None;
        }
        let mut outlines = World::new(world.provenance.clone(), world.bounds);
        let cells = vec![false; frame.len()];
        let inside = OccupancyGrid::from_cells(frame.origin, frame.cell_size, frame.cols, cells);
        let mut inside = inside.ok()?;
        for solid in world.solids() {
            let mut add =
                |shape| outlines.obstacles.push(Obstacle::new(ObstacleKind::Other, shape));
            match &*solid.shape {
                shape @ Shape::Polygon { vertices } if is_large(shape) => {
                    inside.occupy(shape, Coverage::Centre);
                    edges(vertices).for_each(|(a, b)| add(Shape::Segment { a, b }));
                }
                shape => add(shape.clone()),
            }
        }
        Some(Large { outlines, inside })
    }
}

impl FreeGround {
    /// Returns the nearest cell around a point that satisfies a condition and from whose centre a robot can reach
    /// the point.
    fn cell_near(&self, p: DVec2, is_one: impl Fn(usize) -> bool) -> Option<usize> {
        let middle = self.frame.index_at(p)?;
        let offsets =
            (-AROUND..=AROUND).flat_map(|up| (-AROUND..=AROUND).map(move |right| (right, up)));
        let distance2 = |cell: usize| self.frame.center_of(cell).distance_squared(p);
        offsets
            .filter_map(|(right, up)| self.frame.neighbour(middle, right, up))
            .filter(|&cell| is_one(cell) && self.is_free_along(self.frame.center_of(cell), p))
            .min_by(|&a, &b| distance2(a).total_cmp(&distance2(b)))
    }

    fn is_free_along(&self, a: DVec2, b: DVec2) -> bool {
        self.solids.is_clear_along(a, b, ROBOT_RADIUS) && !self.surfaces.barrier_along(a, b).0
    }
}
