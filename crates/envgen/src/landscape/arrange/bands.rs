//! Bands, repeated as often as the Total Edge requires.

use super::grid::{Arranged, Grid};
use super::mixed;
use crate::landscape::construct::{best_bands, descending, stripes};
use crate::landscape::edge::{edge_count, mean_edge_count};

/// Arranges the bands of least Total Edge, or bands with the requested Total Edge.
pub(super) fn arrange(grid: &Grid<'_>, target: Option<u64>) -> Arranged {
    match target {
        None => Arranged::plain(best_bands(grid.rows, grid.cols, grid.counts).0),
        Some(target) => towards(grid, target),
    }
}

/// Arranges bands for targets up to the Total Edge of the rows that alternate as often as possible without
/// exceeding the target; for greater targets, and those above the mean of random landscapes, arranges cells as
/// `mixed`.
fn towards(grid: &Grid<'_>, target: u64) -> Arranged {
    let (rows, cols) = (grid.rows, grid.cols);
    let mean = mean_edge_count(rows as u64, cols as u64, grid.counts);
    if target as f64 > mean {
        return mixed::towards(grid, target, 0.0);
    }
    let mut classes = descending(grid.counts);
    grid.seed.stream("landscape/bands", 0).shuffle(&mut classes);
    let edges = |repeats: u32| edge_count(&stripes(rows, cols, &classes, repeats), cols);
    if edges(1) > target {
        return mixed::towards(grid, target, 0.0);
    }
    // More repeats than rows make no more bands of whole rows, and more repeats than the mean number of
    // cells per class leave classes out.
    let most = rows.min(rows * cols / classes.len().max(1)) as u32;
    let (mut low, mut high) = (1, most.max(1) + 1);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if edges(middle) <= target {
            low = middle;
        } else {
            high = middle;
        }
    }
    grid.repaired(&stripes(rows, cols, &classes, low), target)
}
