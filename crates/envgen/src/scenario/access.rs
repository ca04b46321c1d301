//! What can be reached while doors are open or closed.

use glam::DVec2;

use super::doors::DoorShape;
use super::plan::shapes;
use super::rooms::{places_of_cells, rooms_of_cells};
use super::{Leaf, Scenario};
use crate::clearance_index::ClearanceIndex;
use crate::error::SpecError;
use crate::flood::flood;
use crate::geometry::{Shape, distance_to_segment};
use crate::grid::GridFrame;
use crate::surface_index::{Ground, SurfaceIndex};
use crate::world::{Wall, WallKind, World};

/// Side of a cell in metres, where the world is not too large for it and the disc not too small.
const CELL: f64 = 0.1;

/// The most cells.
const MAX_CELLS: f64 = (1 << 24) as f64;

/// A disc of a radius out of these limits is refused, in metres.
const RADII: [f64; 2] = [0.01, 10.0];

/// What cannot be reached from the start while a door is closed and all others are open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BehindDoor {
    /// The index of the door in [`Scenario::doors`].
    pub door: usize,
    /// The indices of the rooms in [`World::rooms`].
    pub rooms: Vec<u32>,
    /// The indices in [`World::surfaces`] of the floors of hallways and open areas, which have no names.
    pub hallways: Vec<u32>,
    /// Whether the goal is there.
    pub goal: bool,
}

impl Scenario {
    /// The world with the leaves of all doors where they are open, as walls: what is promised of a world can be
    /// verified of it as well.
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

    /// The doors that are the only path of a disc to a room, a piece of a hallway or the goal, each with what is
    /// behind it: what the disc reaches from the start with all doors open, and not with this one closed. Found on a
    /// grid of cells of 0.1 m, or more in worlds of more than 0.16 square kilometres.
    ///
    /// # Errors
    /// When the scenario does not fit the world, or `radius` in metres is not from 0.01 to 10.
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
        let seen = |mut open: Vec<bool>| {
            let mut found = Reached {
                rooms: vec![false; world.rooms.len() + 1],
                hallways: vec![false; floors.len() + 1],
                goal: false,
            };
            if let Some(first) = space.near(start.position) {
                flood(space.frame.cols, &mut open, first, |run| {
                    found.goal |= goal.is_some_and(|goal| run.contains(&goal));
                    for cell in run {
                        found.rooms[rooms[cell] as usize] = true;
                        found.hallways[hallways[cell] as usize] = true;
                    }
                });
            }
            found
        };
        let all = seen(space.cells.clone());
        let mut behind = Vec::new();
        for (door, shape) in shapes(world, &self.doors).iter().enumerate() {
            let left = seen(space.with_closed(shape, radius));
            let rooms: Vec<u32> = (0..)
                .zip(lost(&all.rooms, &left.rooms))
                .filter(|room| room.1)
                .map(|room| room.0)
                .collect();
            let hallways = indices.iter().zip(lost(&all.hallways, &left.hallways));
            let hallways: Vec<u32> =
                hallways.filter(|hallway| hallway.1).map(|hallway| *hallway.0).collect();
            let goal = all.goal && !left.goal;
            if !rooms.is_empty() || !hallways.is_empty() || goal {
                behind.push(BehindDoor { door, rooms, hallways, goal });
            }
        }
        Ok(behind)
    }
}

/// What a disc reaches. The first of the rooms and of the hallways is what is in none.
struct Reached {
    rooms: Vec<bool>,
    hallways: Vec<bool>,
    goal: bool,
}

/// Which places were reached before and are not now. The first entry, of cells in no place, is left out.
fn lost(before: &[bool], now: &[bool]) -> impl Iterator<Item = bool> {
    before.iter().zip(now).skip(1).map(|(before, now)| *before && !now)
}

/// The cells in whose middle a disc fits.
struct FreeCells {
    frame: GridFrame,
    cells: Vec<bool>,
}

impl FreeCells {
    fn new(world: &World, radius: f64) -> Result<Self, SpecError> {
        let size = world.bounds.size();
        let side = CELL.min(radius).max((size.x * size.y / MAX_CELLS).sqrt());
        let side = side.max(size.max_element() / MAX_CELLS);
        let count = (size / side).ceil().max(DVec2::ONE);
        let (cols, rows) = (count.x as usize, count.y as usize);
        let frame = GridFrame { origin: world.bounds.min, cell_size: side, cols, rows };
        let index = ClearanceIndex::new(world, radius)?;
        let deep = SurfaceIndex::of(world, Ground::is_barrier);
        let is_free = |p| index.clearance(p) >= radius && !deep.at(p).is_barrier();
        let cells = (0..frame.len()).map(|cell| is_free(frame.center_of(cell)));
        Ok(FreeCells { frame, cells: cells.collect() })
    }

    /// The free cell at a point, or one of those around it.
    fn near(&self, p: DVec2) -> Option<usize> {
        let here = self.frame.index_at(p)?;
        let around = (-1..=1).flat_map(|up| (-1..=1).map(move |right| (right, up)));
        let beside = around.filter_map(|(right, up)| self.frame.neighbour(here, right, up));
        std::iter::once(here).chain(beside).find(|cell| self.cells[*cell])
    }

    /// The cells with a door closed, across its doorway.
    fn with_closed(&self, door: &DoorShape, radius: f64) -> Vec<bool> {
        let mut cells = self.cells.clone();
        let [a, b] = door.ends;
        let around = Shape::Segment { a, b }.bounds().grown(radius);
        let low = (around.min - self.frame.origin) / self.frame.cell_size;
        let high = (around.max - self.frame.origin) / self.frame.cell_size;
        for row in low.y.max(0.0) as usize..self.frame.rows.min(high.y.max(0.0) as usize + 1) {
            for col in low.x.max(0.0) as usize..self.frame.cols.min(high.x.max(0.0) as usize + 1) {
                if distance_to_segment(self.frame.center(col, row), a, b) < radius {
                    cells[self.frame.index(col, row)] = false;
                }
            }
        }
        cells
    }
}
