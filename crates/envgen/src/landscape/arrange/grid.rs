//! The input and the output of every arrangement.

use crate::landscape::search::Board;
use crate::seed::Seed;

/// The grid to fill: its size, and the number of cells of each class, with class 1 first.
pub(in crate::landscape) struct Grid<'a> {
    pub(in crate::landscape) rows: usize,
    pub(in crate::landscape) cols: usize,
    pub(in crate::landscape) counts: &'a [u32],
    pub(in crate::landscape) seed: Seed,
}

impl Grid<'_> {
    /// Swaps cells of an arrangement until it has the Total Edge, or is as near to it as possible.
    pub(super) fn repaired(&self, cells: &[u16], target: u64) -> Arranged {
        let mut board = Board::new(cells, self.cols);
        let swaps = board.seek(target, &mut self.seed.stream("landscape/repair", 0));
        Arranged { swaps, ..Arranged::plain(board.cells()) }
    }
}

/// The cells of an arrangement, and how they were found.
pub(in crate::landscape) struct Arranged {
    /// The class of each cell, counted from 1, row by row from the top.
    pub(in crate::landscape) cells: Vec<u16>,
    /// The automaton's probability, if the automaton was used.
    pub(in crate::landscape) epsilon: Option<f64>,
    /// The smoothing in cells, if smoothing was used.
    pub(in crate::landscape) sigma: Option<f64>,
    /// Number of swaps that the Total Edge required.
    pub(in crate::landscape) swaps: u64,
}

impl Arranged {
    pub(super) fn plain(cells: Vec<u16>) -> Self {
        Arranged { cells, epsilon: None, sigma: None, swaps: 0 }
    }
}
