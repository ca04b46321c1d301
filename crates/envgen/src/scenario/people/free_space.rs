//! The space in which people can walk: exact clearances, and a grid on which paths are searched.

use std::sync::Arc;

use glam::DVec2;

use crate::clearance_index::ClearanceIndex;
use crate::error::SpecError;
use crate::geometry::{distance_between_segments, distance_to_segment, split_segment};
use crate::grid::{CellBuckets, GridFrame};
use crate::scenario::doors::{DoorShape, Leaf};
use crate::scenario::person::PERSON_RADIUS;
use crate::scenario::spec::ScenarioSpec;
use crate::surface_index::{Ground, SurfaceIndex};
use crate::world::World;

/// The greatest distance in metres up to which clearances and contacts are known.
pub(in crate::scenario) const REACH: f64 = 2.0;

/// Side of a cell in metres, unless the world is too large for it.
const CELL: f64 = 0.2;

/// The greatest number of cells. In larger worlds, cells are larger, so that narrow passages of very large worlds
/// may be missed.
const MAX_CELLS: f64 = (1 << 20) as f64;

/// The distance in metres, in addition to a person's radius, that paths keep from solids, so that rounding errors
/// lead nobody into a wall.
pub(super) const CARE: f64 = 0.01;

/// The distance in metres by which the start of a person who was pushed against a solid may be nearer to it.
const TOUCH: f64 = 0.002;

/// An upper bound, in metres, of the rounding error of a distance.
pub(super) const ROUNDING: f64 = 1e-9;

/// An upper bound, in metres, of the error of a cell's clearance that is rounded to `f32`.
const CELL_ROUNDING: f64 = 1e-6;

/// Length in metres of the pieces in which lines near solids are examined.
const PIECE: f64 = 1.0;

/// Length in metres of the steps in which the ground is examined.
const STEP: f64 = 0.1;

/// The eight neighbours of a cell, counter-clockwise from the right.
pub(super) const NEIGHBOURS: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Costs of a step to the side and of a diagonal step; their ratio is nearly that of 1 to the square root of 2.
pub(super) const COSTS: [u32; 2] = [5, 7];

/// The free space of a disc of a person's radius.
#[derive(Clone, Debug)]
pub(crate) struct FreeSpace {
    pub(crate) frame: GridFrame,
    /// For each cell, the neighbours that can be reached from it in a straight line.
    pub(super) moves: Vec<u8>,
    /// Clearance at the centre of each cell, at most [`REACH`].
    clearances: Vec<f32>,
    pub(super) index: Arc<ClearanceIndex>,
    /// The ground on which people do not walk.
    surfaces: SurfaceIndex,
    /// The leaves of swinging doors in their open position.
    open_leaves: Vec<Leaf>,
    /// For each cell, the leaves within reach.
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
        let surfaces = SurfaceIndex::of(world, Ground::is_barrier);
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
        space.moves = space.find_moves();
        space
    }

    /// Whether people can walk on all of the ground.
    pub(super) fn is_firm_everywhere(&self) -> bool {
        self.surfaces.is_plain()
    }

    fn is_firm(&self, p: DVec2) -> bool {
        !self.surfaces.at(p).is_barrier()
    }

    /// Returns the leaves of open doors within reach of a point, and perhaps a few more.
    fn leaves_near(&self, p: DVec2) -> impl Iterator<Item = Leaf> + '_ {
        let leaves = self.frame.index_at(p).map_or(&[][..], |cell| self.near_leaves.of(cell));
        leaves.iter().map(|&i| self.open_leaves[i as usize])
    }

    /// Returns the distance to the nearest solid or leaf of an open door; infinite beyond [`REACH`].
    fn clearance(&self, p: DVec2) -> f64 {
        let leaves = self.leaves_near(p).map(|leaf| distance_to_segment(p, leaf.hinge, leaf.tip));
        leaves.fold(self.index.clearance(p), f64::min)
    }

    /// Whether a person fits at the centre of a cell, with the margin [`CARE`].
    pub(super) fn is_free(&self, cell: usize) -> bool {
        f64::from(self.clearances[cell]) >= PERSON_RADIUS + CARE
    }

    /// Returns the clearance at the centre of a cell, at most [`REACH`].
    pub(super) fn cell_clearance(&self, cell: usize) -> f64 {
        f64::from(self.clearances[cell])
    }

    /// The moves from every cell: each straight line is checked once for both directions.
    fn find_moves(&self) -> Vec<u8> {
        let mut moves = vec![0; self.frame.len()];
        for cell in (0..self.frame.len()).filter(|&cell| self.is_free(cell)) {
            let a = self.frame.center_of(cell);
            // The other half of the directions are the opposite ones.
            for (i, &(right, up)) in NEIGHBOURS[..4].iter().enumerate() {
                let Some(other) = self.frame.neighbour(cell, right, up) else { continue };
                if self.is_free(other) && self.is_clear(a, self.frame.center_of(other)) {
                    moves[cell] |= 1 << i;
                    moves[other] |= 1 << (i + 4);
                }
            }
        }
        moves
    }

    /// Whether a person can walk from `a` to `b` in a straight line, with the margin [`CARE`].
    pub(super) fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        self.is_clear_for(PERSON_RADIUS + CARE, a, b)
    }

    /// Like [`FreeSpace::is_clear`], for a person who was pushed to `a`, perhaps with a smaller margin.
    pub(super) fn is_clear_from(&self, a: DVec2, b: DVec2) -> bool {
        const MOST: f64 = PERSON_RADIUS + CARE;
        let least = self.clearance_by_cell(a);
        let clearance = if least > MOST + ROUNDING { least } else { self.clearance(a) };
        self.is_clear_for((clearance - ROUNDING).clamp(PERSON_RADIUS - TOUCH, MOST), a, b)
    }

    /// Like [`FreeSpace::is_clear`], but without a margin, and ignoring open leaves, which may close.
    pub(super) fn is_squeezed_clear(&self, a: DVec2, b: DVec2) -> bool {
        self.index.is_clear_along(a, b, PERSON_RADIUS - TOUCH) && self.is_firm_along(a, b)
    }

    fn is_clear_for(&self, needed: f64, a: DVec2, b: DVec2) -> bool {
        let length = a.distance(b);
        let at = |along: f64| if along < length { a.lerp(b, along / length) } else { b };
        let (mut from, mut along) = (a, 0.0);
        loop {
            // As far as the clearance of a cell tells, or exactly for a while.
            let room = self.clearance_by_cell(from) - needed;
            let is_known = room > self.frame.cell_size;
            along += if is_known { room } else { PIECE };
            let to = at(along);
            let is_clear = is_known
                || self.index.is_clear_along(from, to, needed)
                    && self.leaves_are_off(needed, from, to);
            if !is_clear {
                return false;
            }
            if along >= length {
                return self.is_firm_along(a, b);
            }
            from = to;
        }
    }

    /// Returns a lower bound of the distance from a point to the nearest solid or leaf of an open door, from the
    /// clearance at the centre of its cell.
    #[inline]
    fn clearance_by_cell(&self, p: DVec2) -> f64 {
        self.frame.cell_at(p).map_or(0.0, |(col, row)| {
            let clearance = self.cell_clearance(self.frame.index(col, row));
            clearance - self.frame.center(col, row).distance(p) - CELL_ROUNDING
        })
    }

    /// Whether no leaf of an open door is nearer than `needed` metres to a line.
    fn leaves_are_off(&self, needed: f64, a: DVec2, b: DVec2) -> bool {
        if self.open_leaves.is_empty() {
            return true;
        }
        // A cell lists the leaves within reach of it, which is more than half a piece and what is needed.
        split_segment(a, b, REACH).all(|(from, to)| {
            self.leaves_near(from.midpoint(to)).all(|Leaf { hinge, tip }| {
                distance_between_segments(from, to, hinge, tip) >= needed
            })
        })
    }

    fn is_firm_along(&self, a: DVec2, b: DVec2) -> bool {
        if self.is_firm_everywhere() {
            return true;
        }
        let steps = (a.distance(b) / STEP).ceil().max(1.0);
        (0..=steps as usize).all(|k| self.is_firm(a.lerp(b, k as f64 / steps)))
    }

    /// Whether a person fits at a point, considering only solids.
    pub(crate) fn fits(&self, p: DVec2) -> bool {
        let is_off_solids =
            self.clearance_by_cell(p) >= PERSON_RADIUS || self.index.clearance(p) >= PERSON_RADIUS;
        is_off_solids && self.is_firm(p)
    }

    /// Returns for each cell whether it is in the part of the free space that is used: the part that contains
    /// `start`, or otherwise the largest part.
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

    /// Returns the cells next to a cell that can be reached from it, with their directions.
    pub(super) fn reachable(&self, cell: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let moves = self.moves[cell];
        NEIGHBOURS
            .iter()
            .enumerate()
            .filter(move |(i, _)| moves & (1 << i) != 0)
            .filter_map(move |(i, &(right, up))| Some((i, self.frame.neighbour(cell, right, up)?)))
    }

    /// Returns the error for a number of people of which only `fit` fit.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::indoor::IndoorSpec;
    use crate::scenario::Scenario;
    use crate::scenario::plan::shapes;
    use crate::{Blueprint, Seed, Spec};

    #[test]
    fn what_cells_show_of_lines_and_points_is_exact() {
        let world = IndoorSpec::default().generate(Seed(7)).unwrap().to_world();
        let spec = ScenarioSpec { doors: 1.0, ..Default::default() };
        let doors = shapes(&world, &Scenario::new(&world, &spec, Seed(1)).unwrap().doors);
        let index = Arc::new(ClearanceIndex::new(&world, REACH).unwrap());
        let space = FreeSpace::new(&world, &doors, index);
        let mut draws = Seed(2).stream("test", 0);
        let size = world.bounds.size();
        let mut clear = 0;
        for k in 0..20_000 {
            let a = world.bounds.min + DVec2::new(draws.unit(), draws.unit()) * size;
            let b = a + 4.0 * DVec2::new(draws.unit() - 0.5, draws.unit() - 0.5);
            let needed = [PERSON_RADIUS - TOUCH, PERSON_RADIUS + CARE][k % 2];
            let exact = space.index.is_clear_along(a, b, needed)
                && space.leaves_are_off(needed, a, b)
                && space.is_firm_along(a, b);
            assert_eq!(space.is_clear_for(needed, a, b), exact, "{a} to {b}, {needed}");
            clear += u32::from(exact);
            assert_eq!(space.fits(a), space.index.clearance(a) >= PERSON_RADIUS, "{a}");
        }
        assert!((2000..15_000).contains(&clear), "{clear}");
    }
}
