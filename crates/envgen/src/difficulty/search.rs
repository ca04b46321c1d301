//! Shortest paths over the cells of a space.

use super::space::Space;

/// Costs of a move to the side and of a diagonal move. Their ratio, 1.4, is within 1 % of the root of two.
const COSTS: [u32; 2] = [5, 7];

/// The greatest total number of cells that the searches of a tour visit, which takes about a second.
pub const MAX_VISITS: usize = 1 << 25;

/// Buckets of cells by cost (R. B. Dial, Algorithm 360: shortest-path forest with topological ordering,
/// Comm. ACM 12(11), 1969, doi:10.1145/363269.363610), which are kept from one search to the next.
pub(super) struct Search {
    cells: Vec<Reached>,
    buckets: [Vec<u32>; 8],
    searches: u32,
    /// Number of visits that are left.
    visits: usize,
}

/// The state of a cell in a search.
#[derive(Clone, Copy, Debug, Default)]
struct Reached {
    cost: u32,
    /// The search in which it was last reached.
    search: u32,
    /// The cell before it on the path.
    before: u32,
}

impl Search {
    pub(super) fn new(cells: usize) -> Self {
        Search {
            cells: vec![Reached::default(); cells],
            buckets: Default::default(),
            searches: 0,
            visits: MAX_VISITS,
        }
    }

    /// Returns the cells of the shortest path from a cell to the nearest goal, both included. Returns `None` if
    /// there are no goals, and when [`MAX_VISITS`] are used up.
    pub(super) fn nearest(
        &mut self,
        space: &Space<'_>,
        from: usize,
        is_goal: impl Fn(usize) -> bool,
    ) -> Option<Vec<usize>> {
        self.searches += 1;
        self.buckets.iter_mut().for_each(Vec::clear);
        self.reach(from, from, 0);
        let (mut cost, mut empty) = (0_u32, 0);
        while empty < self.buckets.len() {
            let bucket = std::mem::take(&mut self.buckets[cost as usize % 8]);
            empty = if bucket.is_empty() { empty + 1 } else { 0 };
            for &cell in &bucket {
                let cell = cell as usize;
                // A cheaper path to it was found later.
                if self.cells[cell].cost != cost {
                    continue;
                }
                self.visits = self.visits.checked_sub(1)?;
                if is_goal(cell) {
                    return Some(self.path(from, cell));
                }
                for (bit, other) in space.neighbours(cell) {
                    let cost = cost + COSTS[bit % 2];
                    let known = self.cells[other];
                    if known.search != self.searches || cost < known.cost {
                        self.reach(other, cell, cost);
                    }
                }
            }
            self.buckets[cost as usize % 8] = bucket;
            self.buckets[cost as usize % 8].clear();
            cost += 1;
        }
        None
    }

    fn reach(&mut self, cell: usize, before: usize, cost: u32) {
        self.cells[cell] = Reached { cost, search: self.searches, before: before as u32 };
        self.buckets[cost as usize % 8].push(cell as u32);
    }

    fn path(&self, from: usize, to: usize) -> Vec<usize> {
        let mut path = vec![to];
        let mut cell = to;
        while cell != from {
            cell = self.cells[cell].before as usize;
            path.push(cell);
        }
        path.reverse();
        path
    }
}
