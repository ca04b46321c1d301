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

/// Side of a cell in metres, unless the disc is too small for it.
const CELL: f64 = 0.1;

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
    /// door closed. They are found on a grid of cells of 0.1 m, or of the radius if that is less.
    ///
    /// # Errors
    /// When the scenario does not fit the world, when `radius` in metres is not from 0.01 to 10, or when the world
    /// has more than 16,777,216 such cells.
    pub fn behind_doors(&self, world: &World, radius: f64) -> Result<Vec<BehindDoor>, SpecError> {
        self.check(world)?;
        if !(RADII[0]..=RADII[1]).contains(&radius) {
            let allowed = format!("a number from {} to {}", RADII[0], RADII[1]);
            return Err(SpecError::new("radius", radius, allowed));
        }
        let Some(start) = world.start else { return Ok(Vec::new()) };
        let space = FreeCells::new(&self.with_open_doors(world)?, radius)?;
        let rooms = rooms_of_cells(world, space.frame);
        let (indices, floors): (Vec<u32>, Vec<&Shape>) = (0..)
            .zip(&world.surfaces)
            .filter(|(_, surface)| surface.kind.is_hall())
            .map(|(index, surface)| (index, &surface.shape))
            .unzip();
        let hallways = places_of_cells(floors.iter().copied(), space.frame);
        let goal = world.goal.and_then(|goal| space.frame.index_at(goal.position));
        let closed: Vec<Vec<usize>> = shapes(world, &self.doors)
            .iter()
            .map(|door| space.closed_by(door, radius).collect())
            .collect();
        let graph = DoorGraph::new(space.frame.cols, &space.cells, &closed);
        let start = space.near(start.position).and_then(|cell| graph.piece(cell));
        let Some(start) = start else { return Ok(Vec::new()) };
        let room_of = Places::new(&graph, &rooms);
        let hallway_of = Places::new(&graph, &hallways);
        let goal = goal.and_then(|cell| graph.piece(cell));
        let all = graph.reached(start, None);
        let mut behind = Vec::new();
        for door in 0..closed.len() {
            let left = graph.reached(start, Some(door as u32));
            let rooms: Vec<u32> = room_of.lost(&all, &left).collect();
            let hallways = hallway_of.lost(&all, &left);
            let hallways: Vec<u32> = hallways.map(|place| indices[place as usize]).collect();
            let goal = goal.is_some_and(|piece| all[piece] && !left[piece]);
            if !rooms.is_empty() || !hallways.is_empty() || goal {
                behind.push(BehindDoor { door, rooms, hallways, goal });
            }
        }
        Ok(behind)
    }
}

/// The places of a world, with the pieces of ground that they contain.
struct Places {
    /// The pieces of each place, in the order of the places.
    pieces: Vec<(u32, Vec<usize>)>,
}

impl Places {
    /// Creates the places from `place_of`, which contains the place of each cell, counted from 1; 0 for cells in no
    /// place.
    fn new(graph: &DoorGraph, place_of: &[u32]) -> Self {
        let mut pieces: BTreeMap<u32, BTreeSet<usize>> = BTreeMap::new();
        for (cell, &place) in place_of.iter().enumerate().filter(|(_, place)| **place > 0) {
            if let Some(piece) = graph.piece(cell) {
                pieces.entry(place - 1).or_default().insert(piece);
            }
        }
        let pieces = pieces.into_iter().map(|(place, pieces)| (place, Vec::from_iter(pieces)));
        Places { pieces: pieces.collect() }
    }

    /// Returns the places that were reached before and are not reached now.
    fn lost<'a>(&'a self, before: &'a [bool], now: &'a [bool]) -> impl Iterator<Item = u32> + 'a {
        let is_in = |pieces: &[usize], reached: &[bool]| pieces.iter().any(|&piece| reached[piece]);
        let lost = self
            .pieces
            .iter()
            .filter(move |(_, pieces)| is_in(pieces, before) && !is_in(pieces, now));
        lost.map(|(place, _)| *place)
    }
}

/// The cells at whose centres a disc fits.
struct FreeCells {
    frame: GridFrame,
    cells: Vec<bool>,
}

impl FreeCells {
    fn new(world: &World, radius: f64) -> Result<Self, SpecError> {
        let size = world.bounds.size();
        let side = CELL.min(radius);
        let count = (size / side).ceil().max(DVec2::ONE);
        // In coarser cells usual doorways are too narrow, and leaves too thin.
        if count.x * count.y > MAX_CELLS {
            let allowed =
                format!("an area of at most {} m^2 for doors", (MAX_CELLS * side * side).floor());
            return Err(SpecError::new("bounds", format!("{} x {} m", size.x, size.y), allowed));
        }
        let (cols, rows) = (count.x as usize, count.y as usize);
        let frame = GridFrame { origin: world.bounds.min, cell_size: side, cols, rows };
        let index = ClearanceIndex::new(world, radius)?;
        let deep = SurfaceIndex::of(world, Ground::is_barrier);
        let is_free = |p| index.clearance(p) >= radius && !deep.at(p).is_barrier();
        let cells = (0..frame.len()).map(|cell| is_free(frame.center_of(cell)));
        Ok(FreeCells { frame, cells: cells.collect() })
    }

    /// Returns the free cell at a point, or one of those around it.
    fn near(&self, p: DVec2) -> Option<usize> {
        let here = self.frame.index_at(p)?;
        let around = (-1..=1).flat_map(|up| (-1..=1).map(move |right| (right, up)));
        let beside = around.filter_map(|(right, up)| self.frame.neighbour(here, right, up));
        std::iter::once(here).chain(beside).find(|cell| self.cells[*cell])
    }

    /// Returns the cells that a door closes, across its doorway.
    fn closed_by(&self, door: &DoorShape, radius: f64) -> impl Iterator<Item = usize> {
        let (frame, [a, b]) = (self.frame, door.ends);
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
}
