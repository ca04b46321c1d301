//! Reachability while doors are open or closed.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::door_graph::DoorGraph;
use super::doors::DoorShape;
use super::plan::shapes;
use super::rooms::{places_of_cells, rooms_of_cells};
use super::{Leaf, Scenario};
use crate::clearance_index::ClearanceIndex;
use crate::error::SpecError;
use crate::geometry::{Shape, distance_to_segment};
use crate::grid::GridFrame;
use crate::surface_index::{Ground, SurfaceIndex};
use crate::world::{Wall, WallKind, World};

/// The least and the greatest side of a cell in metres, unless the disc is too small for it.
const SIDES: [f64; 2] = [0.02, 0.1];

/// The number of cells above which they are larger than the least ones.
const USUAL_CELLS: f64 = (1 << 20) as f64;

/// The greatest number of cells.
const MAX_CELLS: f64 = (1 << 24) as f64;

/// The least and the greatest allowed radius of a disc in metres.
const RADII: [f64; 2] = [0.01, 10.0];

/// The places that cannot be reached from the start while a door is closed and all others are open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BehindDoor {
    /// The index of the door in [`Scenario::doors`].
    pub door: usize,
    /// The indices of these rooms in [`World::rooms`].
    pub rooms: Vec<u32>,
    /// The indices in [`World::surfaces`] of the floors of these hallways and open areas, which have no names.
    pub hallways: Vec<u32>,
    /// Whether the goal cannot be reached.
    pub goal: bool,
}

impl Scenario {
    /// Returns the world with the leaves of all open doors as walls, so that the promises of the world can be
    /// verified with them, too.
    ///
    /// # Errors
    /// When the scenario does not fit the world.
    pub fn with_open_doors(&self, world: &World) -> Result<World, SpecError> {
        self.check(world)?;
        let leaves = shapes(world, &self.doors).into_iter().flat_map(|door| door.leaves(1.0));
        let mut world = world.clone();
        world.walls.extend(leaves.map(|Leaf { hinge, tip }| {
            Wall::new(WallKind::Partition, Shape::Segment { a: hinge, b: tip })
        }));
        Ok(world)
    }

    /// Returns the doors through which all paths of a disc to a room, a piece of a hallway or the goal lead, each
    /// with the places behind it: those that the disc reaches from the start with all doors open, but not with this
    /// door closed.
    ///
    /// They are found on a grid of cells of 0.02 m, or up to 0.1 m in large worlds. Another path is taken as possible if
    /// a disc whose radius is half a cell's diagonal less finds it from centre to centre in the world without leaves, so
    /// that no place is returned that has another path. A place that has such a path only for the smaller disc, or
    /// across the leaf of an open door, is missing.
    ///
    /// # Errors
    /// When the scenario does not fit the world, when `radius` in metres is not from 0.01 to 10, or when the world
    /// has doors and more than 16,777,216 cells of 0.1 m, or of half the radius if that is less.
    pub fn behind_doors(&self, world: &World, radius: f64) -> Result<Vec<BehindDoor>, SpecError> {
        self.check(world)?;
        if !(RADII[0]..=RADII[1]).contains(&radius) {
            let allowed = format!("a number from {} to {}", RADII[0], RADII[1]);
            return Err(SpecError::new("radius", radius, allowed));
        }
        let Some(start) = world.start.filter(|_| !self.doors.is_empty()) else {
            return Ok(Vec::new());
        };
        let cells = FreeCells::new(world, &self.with_open_doors(world)?, radius)?;
        let frame = cells.frame;
        let (indices, floors): (Vec<u32>, Vec<&Shape>) = (0..)
            .zip(&world.surfaces)
            .filter(|(_, surface)| surface.kind.is_hall())
            .map(|(index, surface)| (index, &surface.shape))
            .unzip();
        let places = [rooms_of_cells(world, frame), places_of_cells(floors.iter().copied(), frame)];
        let goal = world.goal.and_then(|goal| frame.index_at(goal.position));
        let Some(start) = cells.near(start.position) else { return Ok(Vec::new()) };
        let ends = [Some(start), goal];
        let closed: Vec<Vec<usize>> = shapes(world, &self.doors)
            .iter()
            .map(|door| closed_by(frame, door, cells.least_radius).collect())
            .collect();
        let surely = Paths::new(DoorGraph::new(frame.cols, &cells.surely, &[]), &places, ends);
        let perhaps =
            Paths::new(DoorGraph::new(frame.cols, &cells.perhaps, &closed), &places, ends);
        let all = surely.reached(None);
        let mut behind = Vec::new();
        for door in 0..closed.len() {
            let left = perhaps.reached(Some(door as u32));
            let [rooms, hallways] =
                [0, 1].map(|i| all.places[i].difference(&left.places[i]).copied());
            let rooms: Vec<u32> = rooms.collect();
            let hallways: Vec<u32> = hallways.map(|place| indices[place as usize]).collect();
            let goal = all.goal && !left.goal;
            if !rooms.is_empty() || !hallways.is_empty() || goal {
                behind.push(BehindDoor { door, rooms, hallways, goal });
            }
        }
        Ok(behind)
    }
}

/// The places that are reached from the start.
struct Reached {
    /// The rooms and the hallways.
    places: [BTreeSet<u32>; 2],
    goal: bool,
}

/// The paths from the start to the rooms, the hallways and the goal.
struct Paths {
    graph: DoorGraph,
    /// The pieces of ground that each room and each hallway contains.
    pieces: [BTreeMap<u32, BTreeSet<usize>>; 2],
    start: Option<usize>,
    goal: Option<usize>,
}

impl Paths {
    /// Creates the paths from the places of each cell, counted from 1 (0 for cells in no place), and from the cells of
    /// the start and the goal.
    fn new(graph: DoorGraph, places: &[Vec<u32>; 2], ends: [Option<usize>; 2]) -> Self {
        let pieces = places.each_ref().map(|place_of| {
            let mut pieces: BTreeMap<u32, BTreeSet<usize>> = BTreeMap::new();
            for (cell, &place) in place_of.iter().enumerate().filter(|(_, place)| **place > 0) {
                if let Some(piece) = graph.piece(cell) {
                    pieces.entry(place - 1).or_default().insert(piece);
                }
            }
            pieces
        });
        let [start, goal] = ends.map(|cell| cell.and_then(|cell| graph.piece(cell)));
        Paths { graph, pieces, start, goal }
    }

    /// Returns what is reached while one door is closed, or none.
    fn reached(&self, closed: Option<u32>) -> Reached {
        let Some(start) = self.start else {
            return Reached { places: Default::default(), goal: false };
        };
        let reached = self.graph.reached(start, closed);
        let places = self.pieces.each_ref().map(|places| {
            let places =
                places.iter().filter(|(_, pieces)| pieces.iter().any(|&piece| reached[piece]));
            places.map(|(place, _)| *place).collect()
        });
        Reached { places, goal: self.goal.is_some_and(|piece| reached[piece]) }
    }
}

/// The cells in which the middle of a disc can be.
struct FreeCells {
    frame: GridFrame,
    /// The cells at whose centres the disc fits.
    surely: Vec<bool>,
    /// The cells that may hold a point at which the disc fits without leaves: at their centres a disc of `least_radius`
    /// does.
    perhaps: Vec<bool>,
    /// The disc's radius less half the diagonal of a cell.
    least_radius: f64,
}

impl FreeCells {
    /// Finds the cells of a world, and of the same world with all doors open.
    fn new(world: &World, open: &World, radius: f64) -> Result<Self, SpecError> {
        let size = world.bounds.size();
        let usual = (size.x * size.y / USUAL_CELLS).sqrt();
        // The cells that a closed door closes have no gap.
        let side = usual.clamp(SIDES[0], SIDES[1]).min(0.5 * radius);
        let count = (size / side).ceil().max(DVec2::ONE);
        // In coarser cells usual doorways are too narrow, and leaves too thin.
        if count.x * count.y > MAX_CELLS {
            let allowed =
                format!("an area of at most {} m^2 for doors", (MAX_CELLS * side * side).floor());
            return Err(SpecError::new("bounds", format!("{} x {} m", size.x, size.y), allowed));
        }
        let (cols, rows) = (count.x as usize, count.y as usize);
        let frame = GridFrame { origin: world.bounds.min, cell_size: side, cols, rows };
        let least_radius = radius - 0.5 * std::f64::consts::SQRT_2 * side;
        let [index, with_leaves] = [world, open].map(|world| ClearanceIndex::new(world, radius));
        let (index, with_leaves) = (index?, with_leaves?);
        let deep = SurfaceIndex::of(world, Ground::is_barrier);
        let is_firm_everywhere = deep.is_plain();
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
            .map(|(x, y)| 0.5 * side * DVec2::new(x, y));
        let (mut surely, mut perhaps) = (vec![false; frame.len()], vec![false; frame.len()]);
        for cell in 0..frame.len() {
            let p = frame.center_of(cell);
            let is_firm = |p| is_firm_everywhere || !deep.at(p).is_barrier();
            let (clearance, is_firm_here) = (index.clearance(p), is_firm(p));
            surely[cell] =
                clearance >= radius && is_firm_here && with_leaves.clearance(p) >= radius;
            perhaps[cell] = clearance >= least_radius
                && (is_firm_here || corners.iter().any(|&corner| is_firm(p + corner)));
        }
        Ok(FreeCells { frame, surely, perhaps, least_radius })
    }

    /// Returns the nearest cell to a point, within 0.1 m along each axis, in which the disc surely fits.
    fn near(&self, p: DVec2) -> Option<usize> {
        let here = self.frame.index_at(p)?;
        let reach = (SIDES[1] / self.frame.cell_size).ceil() as isize;
        let around = (-reach..=reach).flat_map(|up| (-reach..=reach).map(move |right| (right, up)));
        let beside = around.filter_map(|(right, up)| self.frame.neighbour(here, right, up));
        let distance2 = |cell: usize| self.frame.center_of(cell).distance_squared(p);
        beside
            .filter(|cell| self.surely[*cell])
            .min_by(|&a, &b| distance2(a).total_cmp(&distance2(b)))
    }
}

/// Returns the cells that a door closes to a disc, across its doorway.
fn closed_by(frame: GridFrame, door: &DoorShape, radius: f64) -> impl Iterator<Item = usize> {
    let [a, b] = door.ends;
    let around = Shape::Segment { a, b }.bounds().grown(radius);
    let low = (around.min - frame.origin) / frame.cell_size;
    let high = (around.max - frame.origin) / frame.cell_size;
    let span = |low: f64, high: f64, len: usize| {
        low.max(0.0) as usize..len.min(high.max(0.0) as usize + 1)
    };
    let cols = span(low.x, high.x, frame.cols);
    let cells = span(low.y, high.y, frame.rows)
        .flat_map(move |row| cols.clone().map(move |col| (col, row)));
    cells
        .filter(move |&(col, row)| distance_to_segment(frame.center(col, row), a, b) < radius)
        .map(move |(col, row)| frame.index(col, row))
}
