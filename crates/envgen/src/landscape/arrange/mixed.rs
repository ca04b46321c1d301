//! Salt-and-pepper landscapes: random swaps, starting from bands or a checkerboard.

use super::grid::{Arranged, Grid};
use crate::landscape::construct::{best_bands, checkerboard, random_bands};
use crate::landscape::edge::{edge_count, mean_edge_count};
use crate::landscape::random_fill::random_fill;
use crate::landscape::search::Board;

/// Arranges a landscape without structure: uniformly random, or with a requested Total Edge, at which `mixing`
/// swaps per cell are tried.
pub(super) fn arrange(grid: &Grid<'_>, target: Option<u64>, mixing: f64) -> Arranged {
    match target {
        None => Arranged::plain(random_fill(grid.counts, grid.seed)),
        Some(target) => towards(grid, target, mixing),
    }
}

pub(super) fn towards(grid: &Grid<'_>, target: u64, mixing: f64) -> Arranged {
    let mut board = Board::new(&start(grid, target), grid.cols);
    let mut stream = grid.seed.stream("landscape/mixing", 0);
    let mut swaps = board.seek(target, &mut stream);
    if board.edges() == target {
        let attempts = mixing * (grid.rows * grid.cols) as f64;
        let met = board.cells();
        board.mix(target, attempts as u64, &mut stream);
        swaps += board.seek(target, &mut stream);
        // At the ends of the range the search may not find the target again.
        if board.edges() != target {
            board = Board::new(&met, grid.cols);
        }
    }
    Arranged { swaps, ..Arranged::plain(board.cells()) }
}

/// Returns the landscape to start from: bands below the mean of random landscapes, a checkerboard above it. From a
/// start beyond the target, random swaps approach the target quickly, whereas un-mixing is slow.
fn start(grid: &Grid<'_>, target: u64) -> Vec<u16> {
    let (rows, cols, counts) = (grid.rows, grid.cols, grid.counts);
    if target as f64 > mean_edge_count(rows as u64, cols as u64, counts) {
        let mut stream = grid.seed.stream("landscape/checkerboard", 0);
        return checkerboard(rows, cols, counts, &mut stream);
    }
    let mut stream = grid.seed.stream("landscape/bands", 0);
    let quick = random_bands(rows, cols, counts, &mut stream);
    if edge_count(&quick, cols) <= target { quick } else { best_bands(rows, cols, counts).0 }
}
