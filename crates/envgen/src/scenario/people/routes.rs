//! Shortest paths between places.

use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use glam::DVec2;

use super::free_space::{COSTS, FreeSpace, NEIGHBOURS, ROUNDING};

/// Half the side, in metres, of the window in which paths to a place are known. It is the greatest distance that
/// people go; it is less if there are so many places that the windows would take more memory than [`MAX_CELLS`].
const WINDOW: f64 = 40.0;

/// The greatest number of cells of all windows. Each cell takes a byte.
const MAX_CELLS: f64 = (1 << 26) as f64;

/// The greatest number of columns and rows to the cell at which a path is entered, and the number for a person who
/// has to squeeze through.
const NEAR: isize = 2;
const FAR: isize = 8;

/// The precision of corners, as the inverse of the relative error of their distance.
const PRECISION: usize = 8;

/// The direction of cells from which no path leads to the place, and of the place itself.
const UNREACHED: u8 = u8::MAX;
const HERE: u8 = 8;

/// The places of a world, with the paths to each.
#[derive(Debug)]
pub(crate) struct Routes {
    pub(crate) places: Vec<DVec2>,
    /// The paths to each place, which are computed when they are first used.
    trees: Vec<OnceLock<Tree>>,
    /// Half the side of the windows in cells.
    reach: usize,
}

/// For each cell around a place, the first step of a shortest path to the place.
#[derive(Debug)]
struct Tree {
    /// Column and row of the lower left cell of the window.
    corner: (usize, usize),
    cols: usize,
    rows: usize,
    steps: Vec<u8>,
    /// For each cell of the window that is a corner of a path so far, the next corner after it. All paths share
    /// these corners; only the part before its first corner is new in each path.
    corners: Mutex<BTreeMap<usize, usize>>,
}

impl Routes {
    pub(crate) fn new(places: Vec<DVec2>, space: &FreeSpace) -> Self {
        let trees = places.iter().map(|_| OnceLock::new()).collect();
        let most = 0.5 * (MAX_CELLS / places.len() as f64).sqrt();
        let reach = (WINDOW / space.frame.cell_size).min(most) as usize;
        Routes { places, trees, reach }
    }

    /// Returns the places to which a path from a point can be known: those around it.
    pub(super) fn around(
        &self,
        space: &FreeSpace,
        from: DVec2,
    ) -> impl Iterator<Item = (usize, DVec2)> + '_ {
        let reach = self.reach as f64 * space.frame.cell_size;
        let places = self.places.iter().copied().enumerate();
        places.filter(move |(_, place)| (*place - from).abs().max_element() <= reach)
    }

    fn tree(&self, space: &FreeSpace, place: usize) -> Option<&Tree> {
        let goal = *self.places.get(place)?;
        Some(self.trees[place].get_or_init(|| Tree::new(space, goal, self.reach)))
    }

    /// Returns the corners of a path to a place, with the last one first; `None` if the place cannot be reached.
    pub(crate) fn path(&self, space: &FreeSpace, from: DVec2, place: usize) -> Option<Vec<DVec2>> {
        let goal = *self.places.get(place)?;
        let tree = self.tree(space, place)?;
        let here = space.frame.index_at(from)?;
        let is_at_middle = space.frame.center_of(here).distance_squared(from) < ROUNDING * ROUNDING;
        let mut path = Vec::new();
        // Most who depart are at a place, which is the middle of a cell, and so a corner.
        let mut corner = if is_at_middle && tree.is_reached(space, here) {
            tree.index(space, here)?
        } else {
            let first = self.entry(space, tree, from)?;
            if space.is_clear_from(from, goal) {
                return Some(vec![goal]);
            }
            let corner = tree.farthest_seen(space, from, vec![tree.index(space, first)?])?;
            path.push(tree.center(space, corner));
            corner
        };
        let mut known = tree.corners.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(next) = tree.next(corner)? {
            corner = match known.get(&corner) {
                Some(&seen) => seen,
                None => {
                    let cells = tree.straight_on(corner, next);
                    let seen = tree.farthest_seen(space, tree.center(space, corner), cells)?;
                    known.insert(corner, seen);
                    seen
                }
            };
            path.push(tree.center(space, corner));
        }
        path.reverse();
        Some(if path.is_empty() { vec![goal] } else { path })
    }

    /// Whether a path to a place begins near a point.
    pub(super) fn begins_near(&self, space: &FreeSpace, from: DVec2, place: usize) -> bool {
        self.tree(space, place).is_some_and(|tree| self.entry(space, tree, from).is_some())
    }

    /// Returns the direction in which a path to a place begins, as known from the grid. This is much less work than
    /// computing the path.
    pub(super) fn direction(&self, space: &FreeSpace, from: DVec2, place: usize) -> Option<DVec2> {
        let tree = self.tree(space, place)?;
        let step = tree.step(space, space.frame.index_at(from)?)?;
        let &(right, up) = NEIGHBOURS.get(usize::from(step))?;
        Some(DVec2::new(right as f64, up as f64))
    }

    /// Returns a cell near a point from which a path leads to the place, and to which the straight line is clear.
    /// For a person who was pushed to a point without a path on the grid, it can be a farther cell, without a
    /// margin.
    fn entry(&self, space: &FreeSpace, tree: &Tree, from: DVec2) -> Option<usize> {
        let here = space.frame.index_at(from)?;
        let is_reached = |cell: usize| tree.is_reached(space, cell);
        let is_near = |cell: usize| space.is_clear_from(from, space.frame.center_of(cell));
        if is_reached(here) && is_near(here) {
            return Some(here);
        }
        let distance = |cell: usize| space.frame.center_of(cell).distance_squared(from);
        let around = |reach: isize| {
            let around =
                (-reach..=reach).flat_map(|up| (-reach..=reach).map(move |right| (right, up)));
            let mut cells: Vec<usize> = around
                .filter_map(|(right, up)| space.frame.neighbour(here, right, up))
                .filter(|cell| is_reached(*cell))
                .collect();
            cells.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
            cells
        };
        around(NEAR).into_iter().find(|cell| is_near(*cell)).or_else(|| {
            around(FAR)
                .into_iter()
                .find(|cell| space.is_squeezed_clear(from, space.frame.center_of(*cell)))
        })
    }
}

impl Tree {
    /// Creates a window in which no cell is reached yet.
    fn of(corner: (usize, usize), (cols, rows): (usize, usize)) -> Self {
        Tree { corner, cols, rows, steps: vec![UNREACHED; cols * rows], corners: Mutex::default() }
    }

    /// Runs Dijkstra's search from a place, with a circle of buckets for the small integer costs (R. B. Dial,
    /// Communications of the ACM 12, 1969).
    fn new(space: &FreeSpace, goal: DVec2, reach: usize) -> Self {
        let frame = space.frame;
        let Some((col, row)) = frame.cell_at(goal) else {
            return Tree::of((0, 0), (0, 0));
        };
        let corner = (col.saturating_sub(reach), row.saturating_sub(reach));
        let cols = (col + reach + 1).min(frame.cols) - corner.0;
        let rows = (row + reach + 1).min(frame.rows) - corner.1;
        let mut tree = Tree::of(corner, (cols, rows));
        let moves = tree.moves(space);
        let offsets = NEIGHBOURS.map(|(right, up)| up * cols as isize + right);
        let mut costs = vec![u32::MAX; cols * rows];
        let mut buckets: [Vec<usize>; 8] = Default::default();
        let start = (row - corner.1) * cols + col - corner.0;
        tree.steps[start] = HERE;
        costs[start] = 0;
        buckets[0].push(start);
        let (mut cost, mut empty) = (0_u32, 0);
        while empty < buckets.len() {
            let Some(cell) = buckets[cost as usize % 8].pop() else {
                cost += 1;
                empty += 1;
                continue;
            };
            empty = 0;
            if costs[cell] != cost {
                continue;
            }
            let mut moves = moves[cell];
            while moves != 0 {
                let direction = moves.trailing_zeros() as usize;
                moves &= moves - 1;
                let other = cell.wrapping_add_signed(offsets[direction]);
                let there = cost + COSTS[direction % 2];
                if there < costs[other] {
                    costs[other] = there;
                    tree.steps[other] = ((direction + 4) % 8) as u8;
                    buckets[there as usize % 8].push(other);
                }
            }
        }
        tree
    }

    /// Returns, for each cell of the window, the neighbours in the window that can be reached from it in a straight
    /// line.
    fn moves(&self, space: &FreeSpace) -> Vec<u8> {
        let without = |leaves: fn(&(isize, isize)) -> bool| {
            let bits = (0..8).filter(|&i| !leaves(&NEIGHBOURS[i]));
            bits.fold(0_u8, |bits, i| bits | 1 << i)
        };
        let mut moves = Vec::with_capacity(self.cols * self.rows);
        for row in 0..self.rows {
            let start = space.frame.index(self.corner.0, self.corner.1 + row);
            let from = moves.len();
            moves.extend_from_slice(&space.moves[start..start + self.cols]);
            moves[from] &= without(|&(right, _)| right < 0);
            if let Some(last) = moves.last_mut() {
                *last &= without(|&(right, _)| right > 0);
            }
        }
        let (below, above) = (without(|&(_, up)| up < 0), without(|&(_, up)| up > 0));
        moves[..self.cols].iter_mut().for_each(|moves| *moves &= below);
        moves[(self.rows - 1) * self.cols..].iter_mut().for_each(|moves| *moves &= above);
        moves
    }

    /// Returns the index of a cell in the window.
    fn index(&self, space: &FreeSpace, cell: usize) -> Option<usize> {
        let (col, row) = space.frame.cell(cell);
        let (col, row) = (col.checked_sub(self.corner.0)?, row.checked_sub(self.corner.1)?);
        (col < self.cols && row < self.rows).then(|| row * self.cols + col)
    }

    /// Returns the centre of a cell of the window.
    fn center(&self, space: &FreeSpace, i: usize) -> DVec2 {
        space.frame.center(self.corner.0 + i % self.cols, self.corner.1 + i / self.cols)
    }

    /// Returns the next cell of the window on the path from a cell; no cell after the last one.
    #[expect(clippy::option_option, reason = "no path and no next cell are different")]
    fn next(&self, i: usize) -> Option<Option<usize>> {
        match *self.steps.get(i)? {
            HERE => Some(None),
            step => {
                let &(right, up) = NEIGHBOURS.get(usize::from(step))?;
                i.checked_add_signed(up * self.cols as isize + right).map(Some)
            }
        }
    }

    /// Returns the cells of the window on the path after a cell that lie straight ahead of it, and therefore in its
    /// sight, beginning with `next`.
    fn straight_on(&self, cell: usize, next: usize) -> Vec<usize> {
        let mut cells = Vec::with_capacity(64);
        cells.push(next);
        let (direction, mut last) = (self.steps[cell], next);
        while self.steps[last] == direction
            && let Some(Some(next)) = self.next(last)
        {
            cells.push(next);
            last = next;
        }
        cells
    }

    /// Returns the farthest cell of the window on the path that is found to be in sight of a point, by doubling and
    /// then halving the steps. The path continues with `cells`, one or more, of which the last can be reached.
    fn farthest_seen(
        &self,
        space: &FreeSpace,
        from: DVec2,
        mut cells: Vec<usize>,
    ) -> Option<usize> {
        let is_seen = |i: usize| space.is_clear(from, self.center(space, i));
        // Numbers of cells, of which the last is seen or hidden.
        let (mut seen, mut step) = (cells.len(), 2 * cells.len());
        while self.extend(&mut cells, step)? && is_seen(cells[step - 1]) {
            seen = step;
            step *= 2;
        }
        let mut hidden = step.min(cells.len() + 1);
        while hidden - seen > 1 + seen / PRECISION {
            let middle = seen.midpoint(hidden);
            if is_seen(cells[middle - 1]) {
                seen = middle;
            } else {
                hidden = middle;
            }
        }
        Some(cells[seen - 1])
    }

    /// Extends a path to a number of cells; returns whether it has so many.
    fn extend(&self, cells: &mut Vec<usize>, count: usize) -> Option<bool> {
        while cells.len() < count {
            match self.next(*cells.last()?)? {
                Some(cell) => cells.push(cell),
                None => return Some(false),
            }
        }
        Some(true)
    }

    /// Whether a path leads from a cell to the place.
    fn is_reached(&self, space: &FreeSpace, cell: usize) -> bool {
        self.step(space, cell).is_some_and(|step| step != UNREACHED)
    }

    /// Returns the direction from a cell of the window towards the place.
    fn step(&self, space: &FreeSpace, cell: usize) -> Option<u8> {
        self.index(space, cell).map(|i| self.steps[i])
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::clearance_index::ClearanceIndex;
    use crate::indoor::IndoorSpec;
    use crate::scenario::people::REACH;
    use crate::{Blueprint, Seed, Spec};

    #[test]
    fn what_lies_straight_on_is_in_sight() {
        let world = IndoorSpec::default().generate(Seed(3)).unwrap().to_world();
        let index = Arc::new(ClearanceIndex::new(&world, REACH).unwrap());
        let space = FreeSpace::new(&world, &[], index);
        let free: Vec<usize> = (0..space.frame.len()).filter(|&cell| space.is_free(cell)).collect();
        let mut farthest = 0;
        for goal in free.iter().step_by(free.len() / 5) {
            let tree = Tree::new(&space, space.frame.center_of(*goal), 100);
            for cell in 0..tree.steps.len() {
                let Some(Some(next)) = tree.next(cell) else { continue };
                let cells = tree.straight_on(cell, next);
                let [from, to] =
                    [cell, cells[cells.len() - 1]].map(|cell| tree.center(&space, cell));
                assert!(space.is_clear(from, to), "{from} to {to}");
                assert!(cells.windows(2).all(|pair| tree.next(pair[0]) == Some(Some(pair[1]))));
                farthest = farthest.max(cells.len());
            }
        }
        assert!(farthest > 10, "{farthest} cells");
    }
}
