//! A search for an exact Total Edge by swaps of two cells, which do not change the classes' counts.

use super::edge::edge_count;
use crate::seed::Stream;

/// The number of rounds of the fine search, after which the nearest landscape found is the result.
const ROUNDS: u32 = 60;

/// The number of sides by which the fine search may get worse than its best in each round, cyclically.
const SLACK: [i64; 8] = [0, 0, 0, 1, 2, 4, 8, 0];

/// The greatest distance from the target during mixing. Landscapes of little or much Total Edge are rare.
const MIXING_WINDOW: i64 = 24;

/// A grid with a frame of zeros, which are not a class, so that every cell has four neighbours.
pub(super) struct Board {
    rows: usize,
    cols: usize,
    cells: Vec<u16>,
    edges: i64,
}

impl Board {
    pub(super) fn new(cells: &[u16], cols: usize) -> Self {
        let rows = cells.len() / cols;
        let mut framed = vec![0; (rows + 2) * (cols + 2)];
        for (row, inner) in cells.chunks_exact(cols).zip(framed.chunks_exact_mut(cols + 2).skip(1))
        {
            inner[1..=cols].copy_from_slice(row);
        }
        Board { rows, cols, cells: framed, edges: edge_count(cells, cols) as i64 }
    }

    pub(super) fn edges(&self) -> u64 {
        self.edges as u64
    }

    /// Returns the cells without the frame.
    pub(super) fn cells(&self) -> Vec<u16> {
        let mut cells = Vec::with_capacity(self.rows * self.cols);
        for inner in self.cells.chunks_exact(self.cols + 2).skip(1).take(self.rows) {
            cells.extend_from_slice(&inner[1..=self.cols]);
        }
        cells
    }

    /// Returns a uniformly random cell. Its bias is under 2^-18, which does not matter for a search.
    #[inline]
    fn draw(&self, bits: u64) -> usize {
        let r = ((bits >> 32) * self.rows as u64) >> 32;
        let c = ((bits & 0xffff_ffff) * self.cols as u64) >> 32;
        (r as usize + 1) * (self.cols + 2) + c as usize + 1
    }

    /// Returns the number of neighbours of a cell that are of a class.
    #[inline]
    fn alike(&self, at: usize, class: u16) -> i64 {
        let stride = self.cols + 2;
        i64::from(self.cells[at - 1] == class)
            + i64::from(self.cells[at + 1] == class)
            + i64::from(self.cells[at - stride] == class)
            + i64::from(self.cells[at + stride] == class)
    }

    /// Returns the change of the Total Edge by a swap of two cells of different class.
    #[inline]
    fn change(&self, u: usize, v: usize) -> i64 {
        let (a, b) = (self.cells[u], self.cells[v]);
        let apart = u.abs_diff(v);
        let before = self.alike(u, a) + self.alike(v, b);
        let mut after = self.alike(u, b) + self.alike(v, a);
        // Both neighbours still count the other's old class; the side between them stays.
        if apart == 1 || apart == self.cols + 2 {
            after -= 2;
        }
        before - after
    }

    /// Swaps two cells if they differ and the result is at most `allowed` away from the target.
    #[inline]
    fn try_swap(&mut self, u: usize, v: usize, target: i64, allowed: i64) -> bool {
        if self.cells[u] == self.cells[v] {
            return false;
        }
        let edges = self.edges + self.change(u, v);
        let accepted = (edges - target).abs() <= allowed;
        if accepted {
            self.cells.swap(u, v);
            self.edges = edges;
        }
        accepted
    }

    fn miss(&self, target: i64) -> i64 {
        (self.edges - target).abs()
    }

    /// Swaps random cells, never away from the target, until the target is reached or `patience` swaps in a row
    /// were useless. Returns the number of accepted swaps.
    fn approach(&mut self, target: i64, patience: u64, stream: &mut Stream) -> u64 {
        let (mut accepted, mut idle) = (0, 0);
        while self.edges != target && idle < patience {
            let (u, v) = (self.draw(stream.bits()), self.draw(stream.bits()));
            let miss = self.miss(target);
            idle += 1;
            if self.try_swap(u, v, target, miss) {
                accepted += 1;
                if self.miss(target) < miss {
                    idle = 0;
                }
            }
        }
        accepted
    }

    /// Brings the Total Edge to `target`, or as near as the search gets; returns the number of swaps.
    ///
    /// Random pairs do nearly all of the search. Near the ends of the range, only few pairs help. There, the cells
    /// are listed by how many of their neighbours are of the same class, and pairs are drawn from random lists,
    /// which finds the rare kinks and corners. In some rounds the search may get worse than its best by a few
    /// sides.
    pub(super) fn seek(&mut self, target: u64, stream: &mut Stream) -> u64 {
        let target = target as i64;
        let cells = (self.rows * self.cols) as u64;
        let patience = (cells / 2).clamp(2_000, 200_000);
        let mut accepted = self.approach(target, patience, stream);
        if self.edges == target {
            return accepted;
        }
        let mut best = (self.miss(target), self.cells.clone(), self.edges);
        let tries = 4096 + (8 * cells).min(1 << 18);
        for round in 0..ROUNDS {
            let slack = SLACK[round as usize % SLACK.len()];
            accepted += self.fine_round(target, slack, tries, stream);
            if self.miss(target) < best.0 {
                best = (self.miss(target), self.cells.clone(), self.edges);
            }
            if best.0 == 0 {
                break;
            }
        }
        (_, self.cells, self.edges) = best;
        accepted
    }

    fn fine_round(&mut self, target: i64, slack: i64, tries: u64, stream: &mut Stream) -> u64 {
        let pools = self.pools();
        let stride = self.cols + 2;
        let steps = [1, stride, stride.wrapping_neg(), 1_usize.wrapping_neg()];
        let pick = |stream: &mut Stream| {
            let pool = &pools[stream.below(pools.len() as u64) as usize];
            pool[stream.below(pool.len() as u64) as usize] as usize
        };
        let start = self.miss(target);
        let mut accepted = 0;
        for _ in 0..tries {
            let u = pick(stream);
            let v = match stream.below(4) {
                0 => u.wrapping_add(steps[stream.below(4) as usize]),
                _ => pick(stream),
            };
            let allowed = self.miss(target).min(start) + slack;
            // The frame has no class and stays.
            if self.cells[v] != 0 && self.try_swap(u, v, target, allowed) {
                accepted += 1;
                if self.edges == target {
                    break;
                }
            }
        }
        accepted
    }

    /// Returns the cells in lists by their number of neighbours, of neighbours of their own class, and of
    /// neighbours of the most common other class.
    fn pools(&self) -> Vec<Vec<u32>> {
        let mut pools = vec![Vec::new(); 125];
        let stride = self.cols + 2;
        for r in 1..=self.rows {
            for at in r * stride + 1..=r * stride + self.cols {
                let own = self.cells[at];
                let around = [at - 1, at + 1, at - stride, at + stride].map(|i| self.cells[i]);
                let degree = around.iter().filter(|&&class| class != 0).count();
                let other = around
                    .iter()
                    .filter(|&&class| class != 0 && class != own)
                    .map(|&class| self.alike(at, class) as usize)
                    .max();
                let alike = self.alike(at, own) as usize;
                pools[degree * 25 + alike * 5 + other.unwrap_or(0)].push(at as u32);
            }
        }
        pools.retain(|pool| !pool.is_empty());
        pools
    }

    /// Swaps random cells `attempts` times at about constant Total Edge, so that the landscape does not depend on
    /// how it was built. The Total Edge is near `target` at the end.
    pub(super) fn mix(&mut self, target: u64, attempts: u64, stream: &mut Stream) {
        let target = target as i64;
        for _ in 0..attempts {
            let (u, v) = (self.draw(stream.bits()), self.draw(stream.bits()));
            let allowed = self.miss(target).max(MIXING_WINDOW);
            self.try_swap(u, v, target, allowed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_swap_changes_the_count_as_predicted(
            cells in prop::collection::vec(1_u16..4, 2..120), cols in 1_usize..12, seed: u64,
        ) {
            prop_assume!(cells.len() >= cols);
            let cells = &cells[..cells.len() / cols * cols];
            let mut board = Board::new(cells, cols);
            let mut stream = Seed(seed).stream("test", 0);
            prop_assert_eq!(board.cells(), cells);
            for _ in 0..50 {
                let (u, v) = (board.draw(stream.bits()), board.draw(stream.bits()));
                board.try_swap(u, v, 0, i64::MAX);
                prop_assert_eq!(board.edges(), edge_count(&board.cells(), cols));
            }
        }
    }

    #[test]
    fn what_cannot_be_met_ends_at_the_nearest() {
        // 18 and 18 cells on 6 x 6: no landscape has 7, 58 or 59.
        let halves: Vec<u16> = (0..36).map(|i| 1 + u16::from(i >= 18)).collect();
        let checks: Vec<u16> = (0..36).map(|i| 1 + (i / 6 + i % 6) % 2).collect();
        for (cells, target, nearest) in
            [(&halves, 7, [6, 8]), (&checks, 59, [60, 60]), (&checks, 58, [57, 57])]
        {
            let mut board = Board::new(cells, 6);
            board.seek(target, &mut Seed(1).stream("test", 0));
            assert!(nearest.contains(&board.edges()), "{target}: {}", board.edges());
        }
    }
}
