//! Counts of how often walks over barriers cross lines, and whether all walks agree.

use glam::DVec2;

use super::budget::{Budget, Doubt};
use crate::geometry::Rect;
use crate::grid::{Convex, GridIndex};
use crate::seed::Seed;

/// Lines, and an index of them.
pub(super) struct Crossings {
    lines: Vec<[DVec2; 2]>,
    /// The weights of the lines: a single number holds the sums over all lines.
    weights: Vec<u64>,
    index: GridIndex,
    /// The last section of a walk with which each line was compared.
    compared: Vec<u64>,
    stretches: u64,
}

impl Crossings {
    pub(super) fn new(lines: &[[DVec2; 2]]) -> Self {
        let lines: Vec<_> = lines.iter().copied().filter(|[a, b]| a != b).collect();
        let around = Rect::around(lines.iter().flatten().copied());
        let around = around.unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
        let around = around.grown(1e-8 * (1.0 + around.size().max_element()));
        let len = lines.len();
        let index = GridIndex::new(around, len as f64, len, None, |i, frame, visit| {
            let [a, b] = lines[i];
            // Rounding must not keep a line out of a cell where it is crossed.
            let margin = 1e-8 * (1.0 + frame.cell_size);
            let across = (b - a).perp().clamp_length(margin, margin);
            let along = (b - a).clamp_length(margin, margin);
            let (a, b) = (a - along, b + along);
            let thick = [a - across, b - across, b + across, a + across];
            frame.touched_runs(&Convex::Polygon(&thick), visit);
        });
        // Sums over several lines vanish by chance once in 2^64.
        let mut stream = Seed(0).stream("certificate/lines", 0);
        let weights = (0..lines.len()).map(|_| stream.bits() | 1).collect();
        Crossings { compared: vec![0; lines.len()], stretches: 0, weights, index, lines }
    }

    /// Returns the sum over all lines of the weight times the crossings of a walk, which are those from left to
    /// right minus those from right to left.
    pub(super) fn of(&mut self, walk: &[DVec2], budget: &mut Budget) -> Result<u64, Doubt> {
        let mut sum = 0_u64;
        let mut visited = 0;
        for stretch in walk.windows(2) {
            self.stretches += 1;
            let Crossings { lines, weights, index, compared, stretches } = self;
            let frame = index.frame;
            frame.touched_runs(&Convex::Polygon(stretch), |row, from, to| {
                for cell in frame.index(from, row)..=frame.index(to, row) {
                    visited += 1 + index.of(cell).len() as u64;
                    for &i in index.of(cell) {
                        let i = i as usize;
                        if std::mem::replace(&mut compared[i], *stretches) == *stretches {
                            continue;
                        }
                        match crossing(lines[i], [stretch[0], stretch[1]]) {
                            1 => sum = sum.wrapping_add(weights[i]),
                            -1 => sum = sum.wrapping_sub(weights[i]),
                            _ => {}
                        }
                    }
                }
            });
        }
        budget.spend(visited)?;
        Ok(sum)
    }
}

/// Returns 1 if a section crosses a line from its left to its right, -1 if from right to left, and 0 if it does not
/// cross. A point on the line counts as left of it, for every section of which it is part.
fn crossing([p, q]: [DVec2; 2], [a, b]: [DVec2; 2]) -> i32 {
    let along = q - p;
    let side = |x: DVec2| along.perp_dot(x - p);
    let (from, to) = (side(a), side(b));
    if (from >= 0.0) == (to >= 0.0) {
        return 0;
    }
    let place = (a + (b - a) * (from / (from - to)) - p).dot(along);
    let within = place > 0.0 && place < along.length_squared();
    match (within, from >= 0.0) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    }
}

/// Sets of elements that walks join (Tarjan's union-find with path halving), with the crossings of the walk to each
/// element from the root of its set.
pub(super) struct Windings {
    parents: Vec<u32>,
    /// The crossings of the walk from the parent.
    sums: Vec<u64>,
}

impl Windings {
    pub(super) fn new(count: usize) -> Self {
        Windings { parents: (0..count as u32).collect(), sums: vec![0; count] }
    }

    /// Returns the root of a set, and the crossings of the walk from it.
    fn root(&mut self, i: usize) -> (usize, u64) {
        let (mut i, mut sum) = (i, 0_u64);
        while self.parents[i] as usize != i {
            let parent = self.parents[i] as usize;
            if self.parents[parent] as usize != parent {
                self.sums[i] = self.sums[i].wrapping_add(self.sums[parent]);
                self.parents[i] = self.parents[parent];
            }
            sum = sum.wrapping_add(self.sums[i]);
            i = self.parents[i] as usize;
        }
        (i, sum)
    }

    /// Joins two elements by a walk from the first to the second. Returns whether its crossings are those of every
    /// other walk between them.
    pub(super) fn join(&mut self, [from, to]: [usize; 2], crossed: u64) -> bool {
        let ((a, before), (b, after)) = (self.root(from), self.root(to));
        let before = before.wrapping_add(crossed);
        if a == b {
            return before == after;
        }
        self.parents[b] = a as u32;
        self.sums[b] = before.wrapping_sub(after);
        true
    }

    pub(super) fn are_joined(&mut self, a: usize, b: usize) -> bool {
        self.root(a).0 == self.root(b).0
    }
}
