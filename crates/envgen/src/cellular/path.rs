//! Paths that keep away from blocks, like those of BARN.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::distance::squared_distances;

/// The greatest distance in metres at which a blocked cell makes a step longer. It is the inflation radius of the
/// planner for which BARN was made.
const INFLATION: f64 = 0.3;

/// A step to a cell beside a blocked cell is longer by this many cells; a step to a cell farther from it, by this
/// divided by the distance in cells.
const PENALTY: f64 = 5.0;

/// The cheapest paths from one free cell, over cells of `side` metres. A step to one of the eight neighbours costs
/// its length and the penalty of the cell to which it leads. No step leads between two blocked cells that touch at
/// a corner.
///
/// BARN's own search adds the penalty to the order in which cells are visited but not to the cost, and turns by at
/// most 45 degrees per step. The paths here are optimal for the cost that its authors intended.
pub(crate) struct CheapestPaths {
    start: usize,
    /// The predecessor of each cell; [`NONE`] for cells that were not reached.
    before: Vec<usize>,
}

/// The predecessor of cells that were not reached.
const NONE: usize = usize::MAX;

impl CheapestPaths {
    /// Finds paths to all cells or, if a goal is given, to the goal.
    pub(crate) fn new(
        cols: usize,
        blocked: &[bool],
        side: f64,
        start: usize,
        goal: Option<usize>,
    ) -> Self {
        let reach = (INFLATION / side).round();
        let squared = squared_distances(cols, blocked);
        let penalty = |cell: usize| {
            let distance = f64::from(squared[cell]).sqrt();
            if distance <= reach { PENALTY / distance } else { 0.0 }
        };
        let rows = blocked.len() / cols;
        let mut cost = vec![f64::INFINITY; blocked.len()];
        let mut before = vec![NONE; blocked.len()];
        cost[start] = 0.0;
        // Costs are not negative, so that their bits are in their order.
        let mut queue = BinaryHeap::from([Reverse((0_u64, start))]);
        while let Some(Reverse((bits, cell))) = queue.pop() {
            if bits != cost[cell].to_bits() {
                continue;
            }
            if goal == Some(cell) {
                break;
            }
            let (row, col) = (cell / cols, cell % cols);
            for (down, right) in STEPS {
                let place = (row.checked_add_signed(down), col.checked_add_signed(right));
                let (Some(to_row), Some(to_col)) = place else { continue };
                if to_row >= rows || to_col >= cols || blocked[to_row * cols + to_col] {
                    continue;
                }
                let is_diagonal = down != 0 && right != 0;
                if is_diagonal && blocked[to_row * cols + col] && blocked[row * cols + to_col] {
                    continue;
                }
                let to = to_row * cols + to_col;
                let step = if is_diagonal { std::f64::consts::SQRT_2 } else { 1.0 };
                let found = cost[cell] + step + penalty(to);
                if found < cost[to] {
                    (cost[to], before[to]) = (found, cell);
                    queue.push(Reverse((found.to_bits(), to)));
                }
            }
        }
        CheapestPaths { start, before }
    }

    /// Whether there is a path to a cell.
    #[cfg(feature = "rmf")]
    pub(crate) fn reaches(&self, cell: usize) -> bool {
        cell == self.start || self.before[cell] != NONE
    }

    /// Returns the path to a cell, including both ends; `None` if no path exists.
    pub(crate) fn to(&self, goal: usize) -> Option<Vec<usize>> {
        let before = |&cell: &usize| Some(self.before[cell]).filter(|&cell| cell != NONE);
        let mut path: Vec<_> = std::iter::successors(Some(goal), before).collect();
        path.reverse();
        (path[0] == self.start).then_some(path)
    }
}

const STEPS: [(isize, isize); 8] =
    [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)];

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cheapest_path(
        cols: usize,
        blocked: &[bool],
        side: f64,
        [start, goal]: [usize; 2],
    ) -> Option<Vec<usize>> {
        CheapestPaths::new(cols, blocked, side, start, Some(goal)).to(goal)
    }

    #[test]
    fn paths_keep_away_from_blocks() {
        // A wall along the top: the direct path beside it is dearer than the one below.
        let blocked: Vec<bool> = (0..70).map(|cell| cell < 10).collect();
        let path = cheapest_path(10, &blocked, 0.15, [10, 19]).unwrap();
        assert_eq!((path[0], path[path.len() - 1]), (10, 19));
        assert!(path.iter().any(|cell| cell / 10 > 2), "{path:?}");
        // In larger cells blocks matter at no distance.
        let path = cheapest_path(10, &blocked, 1.0, [10, 19]).unwrap();
        assert_eq!(path, (10..20).collect::<Vec<_>>());
    }

    #[test]
    fn corners_that_touch_are_closed() {
        let blocked = [false, true, true, false];
        assert_eq!(cheapest_path(2, &blocked, 0.15, [0, 3]), None);
        assert_eq!(cheapest_path(2, &[false; 4], 0.15, [0, 3]), Some(vec![0, 3]));
        assert_eq!(cheapest_path(2, &blocked, 0.15, [3, 3]), Some(vec![3]));
    }

    /// The cost of the cheapest path by relaxing every step until nothing changes.
    fn relaxed(cols: usize, blocked: &[bool], [start, goal]: [usize; 2]) -> f64 {
        let place = |cell: usize| [(cell / cols) as f64, (cell % cols) as f64];
        let away = |a: usize, b: usize| {
            let ([r, c], [s, d]) = (place(a), place(b));
            ((r - s) * (r - s) + (c - d) * (c - d)).sqrt()
        };
        let cells = 0..blocked.len();
        let near = |cell: usize| {
            let away = cells.clone().filter(|&other| blocked[other]).map(|other| away(cell, other));
            away.fold(f64::INFINITY, f64::min)
        };
        let penalty: Vec<f64> = cells
            .clone()
            .map(|cell| if near(cell) <= 2.0 { 5.0 / near(cell) } else { 0.0 })
            .collect();
        let mut cost = vec![f64::INFINITY; blocked.len()];
        cost[start] = 0.0;
        for _ in cells.clone() {
            for a in cells.clone() {
                for b in cells.clone().filter(|&b| a != b && !blocked[b] && away(a, b) < 1.5) {
                    let corners = [a / cols * cols + b % cols, b / cols * cols + a % cols];
                    if !corners.iter().all(|&corner| blocked[corner]) {
                        cost[b] = cost[b].min(cost[a] + away(a, b) + penalty[b]);
                    }
                }
            }
        }
        cost[goal]
    }

    proptest! {
        #[test]
        fn no_path_is_cheaper(
            mut blocked in prop::collection::vec(prop::bool::weighted(0.25), 48),
            start in 0..48_usize,
            goal in 0..48_usize,
        ) {
            (blocked[start], blocked[goal]) = (false, false);
            let expected = relaxed(8, &blocked, [start, goal]);
            match cheapest_path(8, &blocked, 0.15, [start, goal]) {
                None => prop_assert!(expected.is_infinite()),
                Some(path) => {
                    let cost: f64 = path.windows(2).map(|pair| relaxed_step(&blocked, pair)).sum();
                    prop_assert!((cost - expected).abs() < 1e-9, "{cost} {expected}");
                }
            }
        }
    }

    fn relaxed_step(blocked: &[bool], pair: &[usize]) -> f64 {
        let squared = squared_distances(8, blocked);
        let (a, b) = (pair[0], pair[1]);
        let is_diagonal = a / 8 != b / 8 && a % 8 != b % 8;
        let distance = f64::from(squared[b]).sqrt();
        f64::sqrt(if is_diagonal { 2.0 } else { 1.0 })
            + if distance <= 2.0 { 5.0 / distance } else { 0.0 }
    }
}
