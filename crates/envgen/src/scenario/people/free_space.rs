//! Where people can walk: exact clearances, and a grid on which paths are searched.

use std::sync::Arc;

use glam::DVec2;

use crate::clearance_index::ClearanceIndex;
use crate::error::SpecError;
use crate::geometry::nearest_on_segment;
use crate::grid::{CellBuckets, GridFrame};
use crate::scenario::door::{DoorShape, Leaf};
use crate::scenario::{PERSON_RADIUS, REACH, ScenarioSpec};
use crate::surface_index::SurfaceIndex;
use crate::world::World;

/// Side of a cell in metres, where the world is not too large for it.
const CELL: f64 = 0.2;

/// The most cells: more are made larger, so that narrow passages of very large worlds may be missed.
const MAX_CELLS: f64 = (1 << 20) as f64;

/// Paths keep this much more than a person's radius from solids, so that rounding leads nobody into a wall.
pub(super) const CARE: f64 = 0.01;

/// A line is checked at steps of at least this length in metres. Between two checks the clearance is less by
/// at most half of it.
const STEP: f64 = 2.0 * CARE;

/// Someone who was pushed against a solid may start this much nearer to it, in metres.
const TOUCH: f64 = 0.002;

/// The eight neighbours of a cell, counter-clockwise from the right.
pub(super) const NEIGHBOURS: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The free space of a disc of a person's radius.
#[derive(Clone, Debug)]
pub(crate) struct FreeSpace {
    pub(crate) frame: GridFrame,
    /// Which neighbours can be reached from each cell in a straight line.
    pub(super) moves: Vec<u8>,
    /// Clearance at the middle of each cell, at most [`REACH`].
    clearances: Vec<f32>,
    pub(super) index: Arc<ClearanceIndex>,
    surfaces: SurfaceIndex,
    /// The leaves of swinging doors where they are open.
    open_leaves: Vec<Leaf>,
    /// The leaves within reach of each cell.
    near_leaves: CellBuckets<u32>,
}

impl FreeSpace {
    pub(crate) fn new(world: &World, doors: &[DoorShape], index: Arc<ClearanceIndex>) -> Self {
        let size = world.bounds.size();
        let cell = CELL.max((size.x * size.y / MAX_CELLS).sqrt()).max(size.max_element() / 1e6);
        let count = (size / cell).ceil().max(DVec2::ONE);
        let (cols, rows) = (count.x as usize, count.y as usize);
        // Doorways and corridors are often centred in the world: so are the cells.
        let margin = 0.5 * (count * cell - size);
        let frame = GridFrame { origin: world.bounds.min - margin, cell_size: cell, cols, rows };
        let open_leaves: Vec<Leaf> =
            doors.iter().filter(|door| door.swings()).flat_map(|door| door.leaves(1.0)).collect();
        let numbers: Vec<u32> = (0..open_leaves.len() as u32).collect();
        let near_leaves = CellBuckets::build(&frame, &numbers, None, |&i, frame, visit| {
            let leaf = open_leaves[i as usize];
            let shape =
                crate::geometry::Shape::thick_segment(leaf.hinge, leaf.tip, 2.0 * REACH, REACH);
            frame.touched_runs(&crate::grid::Convex::Polygon(&shape.corners()), visit);
        })
        .unwrap_or_else(|| unreachable!("there is no limit"));
        let surfaces = SurfaceIndex::new(world);
        let mut space = FreeSpace {
            frame,
            moves: Vec::new(),
            clearances: vec![0.0; frame.len()],
            index,
            surfaces,
            open_leaves,
            near_leaves,
        };
        for cell in 0..frame.len() {
            let p = frame.center_of(cell);
            let is_inside = world.bounds.grown(-PERSON_RADIUS).contains(p);
            if is_inside && space.is_firm(p) {
                space.clearances[cell] = space.clearance(p).min(REACH) as f32;
            }
        }
        space.moves = (0..frame.len()).map(|cell| space.moves_from(cell)).collect();
        space
    }

    /// Whether people walk on the ground at a point: not on water, nor where nothing can be driven on.
    fn is_firm(&self, p: DVec2) -> bool {
        let ground = self.surfaces.at(p);
        !ground.water && ground.speed > 0.0
    }

    /// Distance to the nearest solid or leaf of a door that is open, infinite beyond [`REACH`].
    fn clearance(&self, p: DVec2) -> f64 {
        let leaves = self.frame.index_at(p).map_or(&[][..], |cell| self.near_leaves.of(cell));
        let leaves = leaves.iter().map(|&i| {
            let Leaf { hinge, tip } = self.open_leaves[i as usize];
            p.distance(nearest_on_segment(p, hinge, tip))
        });
        leaves.fold(self.index.clearance(p), f64::min)
    }

    /// Whether a person fits into the middle of a cell, with some care.
    pub(super) fn is_free(&self, cell: usize) -> bool {
        f64::from(self.clearances[cell]) >= PERSON_RADIUS + CARE
    }

    /// Clearance at the middle of a cell, at most [`REACH`].
    pub(super) fn cell_clearance(&self, cell: usize) -> f64 {
        f64::from(self.clearances[cell])
    }

    fn moves_from(&self, cell: usize) -> u8 {
        if !self.is_free(cell) {
            return 0;
        }
        let mut moves = 0;
        for (i, &(right, up)) in NEIGHBOURS.iter().enumerate() {
            let Some(other) = self.frame.neighbour(cell, right, up) else { continue };
            let (a, b) = (self.frame.center_of(cell), self.frame.center_of(other));
            // The same answer from both ends.
            let (a, b) = if cell < other { (a, b) } else { (b, a) };
            if self.is_free(other) && self.is_clear(a, b) {
                moves |= 1 << i;
            }
        }
        moves
    }

    /// Whether a person with some care can walk from `a` to `b` in a straight line.
    pub(super) fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        self.is_clear_for(PERSON_RADIUS + CARE, STEP, a, b)
    }

    /// As [`FreeSpace::is_clear`] for a person who was pushed to `a`, perhaps with less care.
    pub(super) fn is_clear_from(&self, a: DVec2, b: DVec2) -> bool {
        let needed = self.clearance(a).clamp(PERSON_RADIUS - TOUCH, PERSON_RADIUS + CARE);
        self.is_clear_for(needed, TOUCH, a, b)
    }

    fn is_clear_for(&self, needed: f64, step: f64, a: DVec2, b: DVec2) -> bool {
        let length = a.distance(b);
        let direction = if length > 0.0 { (b - a) / length } else { DVec2::ZERO };
        let mut along = 0.0;
        loop {
            let p = a + direction * along;
            // The clearance changes by no more than the distance from the middle of the cell.
            let bound = self.frame.index_at(p).map_or(0.0, |cell| {
                self.cell_clearance(cell) - p.distance(self.frame.center_of(cell))
            });
            let clearance =
                if bound >= needed + step { bound } else { self.clearance(p).min(REACH) };
            if clearance < needed || !(bound >= needed || self.is_firm(p)) {
                return false;
            }
            if along >= length {
                return true;
            }
            along = (along + (clearance - needed).max(step)).min(length);
        }
    }

    /// Whether a person fits at a point, solids alone considered.
    pub(crate) fn fits(&self, p: DVec2) -> bool {
        self.index.clearance(p) >= PERSON_RADIUS && self.is_firm(p)
    }

    /// For each cell whether it is in the part of the free space that is used: where `start` is, or otherwise
    /// the largest.
    pub(super) fn region(&self, start: Option<DVec2>) -> Vec<bool> {
        const NONE: u32 = u32::MAX;
        let mut regions = vec![NONE; self.frame.len()];
        let mut sizes: Vec<usize> = Vec::new();
        let mut queue = Vec::new();
        for first in 0..self.frame.len() {
            if regions[first] != NONE || !self.is_free(first) {
                continue;
            }
            let number = sizes.len() as u32;
            regions[first] = number;
            queue.push(first);
            let mut size = 0;
            while let Some(cell) = queue.pop() {
                size += 1;
                for other in self.reachable(cell).map(|(_, other)| other) {
                    if regions[other] == NONE {
                        regions[other] = number;
                        queue.push(other);
                    }
                }
            }
            sizes.push(size);
        }
        let at_start = start
            .and_then(|p| self.frame.index_at(p))
            .map(|cell| regions[cell])
            .filter(|&region| region != NONE);
        // Of equal ones the first.
        let largest = || (0..sizes.len()).rev().max_by_key(|&i| sizes[i]).map(|i| i as u32);
        let used = at_start.or_else(largest);
        regions.iter().map(|&region| region != NONE && Some(region) == used).collect()
    }

    /// The cells next to a cell that can be reached from it, with their directions.
    pub(super) fn reachable(&self, cell: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let moves = self.moves[cell];
        NEIGHBOURS
            .iter()
            .enumerate()
            .filter(move |(i, _)| moves & (1 << i) != 0)
            .filter_map(move |(i, &(right, up))| Some((i, self.frame.neighbour(cell, right, up)?)))
    }

    /// The error for a number of people of which only `fit` fit.
    pub(crate) fn too_many(people: usize, fit: usize) -> SpecError {
        let setting = ScenarioSpec::setting("people");
        if fit == 0 {
            let why = format!(
                "0: nowhere in the world is a free disc of radius {PERSON_RADIUS} m that is not in a doorway"
            );
            return setting.error_with(people, why);
        }
        let why = format!("a whole number from 0 to {fit}: no more fit into the free space");
        setting.error_with(people, why)
    }
}
