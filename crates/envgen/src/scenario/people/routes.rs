//! Shortest paths between places.

use std::sync::OnceLock;

use glam::DVec2;

use super::free_space::{FreeSpace, NEIGHBOURS};

/// Half the side of the window in which paths to a place are known, in metres.
const WINDOW: f64 = 40.0;

/// Costs of a step to the side and of a diagonal one: nearly as 1 to the square root of 2.
const COSTS: [u32; 2] = [5, 7];

/// Directions of cells from which no path leads to the place, and of the place itself.
const UNREACHED: u8 = u8::MAX;
const HERE: u8 = 8;

/// The places of a world, with the paths to each.
#[derive(Debug)]
pub(crate) struct Routes {
    pub(crate) places: Vec<DVec2>,
    /// Found when they are first asked for.
    trees: Vec<OnceLock<Tree>>,
}

/// The first step of a shortest path to a place from each cell around it.
#[derive(Debug)]
struct Tree {
    /// Column and row of the window's lower left cell.
    corner: (usize, usize),
    cols: usize,
    rows: usize,
    steps: Vec<u8>,
}

impl Routes {
    pub(crate) fn new(places: Vec<DVec2>) -> Self {
        let trees = places.iter().map(|_| OnceLock::new()).collect();
        Routes { places, trees }
    }

    /// The corners of a path to a place, the last first; `None` where the place cannot be reached.
    pub(crate) fn path(&self, space: &FreeSpace, from: DVec2, place: usize) -> Option<Vec<DVec2>> {
        let goal = *self.places.get(place)?;
        let tree = self.trees[place].get_or_init(|| Tree::new(space, goal));
        let first = self.entry(space, tree, from)?;
        if space.is_clear_from(from, goal) {
            return Some(vec![goal]);
        }
        let mut cells = vec![from];
        let mut cell = first;
        loop {
            cells.push(space.frame.center_of(cell));
            match tree.step(space, cell)? {
                HERE => break,
                step => {
                    let &(right, up) = NEIGHBOURS.get(usize::from(step))?;
                    cell = space.frame.neighbour(cell, right, up)?;
                }
            }
        }
        Some(pulled(space, &cells))
    }

    /// The direction in which a path to a place begins, as the grid knows it; much less work than the path.
    pub(super) fn direction(&self, space: &FreeSpace, from: DVec2, place: usize) -> Option<DVec2> {
        let goal = *self.places.get(place)?;
        let tree = self.trees[place].get_or_init(|| Tree::new(space, goal));
        let step = tree.step(space, space.frame.index_at(from)?)?;
        let &(right, up) = NEIGHBOURS.get(usize::from(step))?;
        Some(DVec2::new(right as f64, up as f64))
    }

    /// A cell near a point from which a path leads to the place, and to which the straight line is clear.
    fn entry(&self, space: &FreeSpace, tree: &Tree, from: DVec2) -> Option<usize> {
        let here = space.frame.index_at(from)?;
        let is_entry = |cell: &usize| {
            tree.step(space, *cell).is_some_and(|step| step != UNREACHED)
                && space.is_clear_from(from, space.frame.center_of(*cell))
        };
        if is_entry(&here) {
            return Some(here);
        }
        let around = (-2..=2).flat_map(|up| (-2..=2).map(move |right| (right, up)));
        let mut cells: Vec<usize> =
            around.filter_map(|(right, up)| space.frame.neighbour(here, right, up)).collect();
        let distance = |cell: usize| space.frame.center_of(cell).distance_squared(from);
        cells.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
        cells.into_iter().find(is_entry)
    }
}

/// The corners of a chain of points after it is pulled tight, the last first and without the first. Each point
/// can be reached from the one before in a straight line.
fn pulled(space: &FreeSpace, chain: &[DVec2]) -> Vec<DVec2> {
    let mut corners = Vec::new();
    let mut at = 0;
    while at + 1 < chain.len() {
        // The farthest point that is found in sight: by doubling, then by halving.
        let (mut seen, mut step) = (at + 1, 2);
        while at + step < chain.len() && space.is_clear(chain[at], chain[at + step]) {
            seen = at + step;
            step *= 2;
        }
        let mut hidden = (at + step).min(chain.len());
        while seen + 1 < hidden {
            let middle = seen.midpoint(hidden);
            if space.is_clear(chain[at], chain[middle]) {
                seen = middle;
            } else {
                hidden = middle;
            }
        }
        corners.push(chain[seen]);
        at = seen;
    }
    corners.reverse();
    corners
}

impl Tree {
    /// Dijkstra's search from a place, with a circle of buckets for the small whole costs (R. B. Dial,
    /// Communications of the ACM 12, 1969).
    fn new(space: &FreeSpace, goal: DVec2) -> Self {
        let frame = space.frame;
        let reach = (WINDOW / frame.cell_size) as usize;
        let Some((col, row)) = frame.cell_at(goal) else {
            return Tree { corner: (0, 0), cols: 0, rows: 0, steps: Vec::new() };
        };
        let corner = (col.saturating_sub(reach), row.saturating_sub(reach));
        let cols = (col + reach + 1).min(frame.cols) - corner.0;
        let rows = (row + reach + 1).min(frame.rows) - corner.1;
        let mut tree = Tree { corner, cols, rows, steps: vec![UNREACHED; cols * rows] };
        let mut costs = vec![u32::MAX; cols * rows];
        let mut buckets: [Vec<usize>; 8] = Default::default();
        let start = frame.index(col, row);
        if let Some(i) = tree.index(space, start) {
            tree.steps[i] = HERE;
            costs[i] = 0;
            buckets[0].push(start);
        }
        let (mut cost, mut empty) = (0_u32, 0);
        while empty < buckets.len() {
            let Some(cell) = buckets[cost as usize % 8].pop() else {
                cost += 1;
                empty += 1;
                continue;
            };
            empty = 0;
            if tree.index(space, cell).is_none_or(|i| costs[i] != cost) {
                continue;
            }
            for (direction, other) in space.reachable(cell) {
                let Some(i) = tree.index(space, other) else { continue };
                let there = cost + COSTS[direction % 2];
                if there < costs[i] {
                    costs[i] = there;
                    tree.steps[i] = ((direction + 4) % 8) as u8;
                    buckets[there as usize % 8].push(other);
                }
            }
        }
        tree
    }

    /// The index of a cell in the window.
    fn index(&self, space: &FreeSpace, cell: usize) -> Option<usize> {
        let (col, row) = space.frame.cell(cell);
        let (col, row) = (col.checked_sub(self.corner.0)?, row.checked_sub(self.corner.1)?);
        (col < self.cols && row < self.rows).then(|| row * self.cols + col)
    }

    /// The direction from a cell of the window towards the place.
    fn step(&self, space: &FreeSpace, cell: usize) -> Option<u8> {
        self.index(space, cell).map(|i| self.steps[i])
    }
}
