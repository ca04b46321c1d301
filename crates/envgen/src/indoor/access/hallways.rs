//! The connectivity of the hallways alone.

use crate::indoor::grid::{Cell, Grid};
use crate::union_find::UnionFind;

/// The connectivity of the hallway cells alone, without rooms and open areas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::indoor) struct HallwayShape {
    pub(in crate::indoor) cells: u64,
    /// Number of connected components.
    pub(in crate::indoor) parts: u64,
    /// Number of independent cycles: links minus cells plus parts.
    pub(in crate::indoor) cycles: u64,
    /// Number of cells with at most one hallway neighbour.
    pub(in crate::indoor) ends: u64,
}

pub(in crate::indoor) fn hallway_shape(grid: &Grid) -> HallwayShape {
    let hallway = |x: u32, y: u32| grid.get(x, y) == Some(Cell::Hallway);
    let mut sets = UnionFind::new(grid.cells().len());
    let (mut cells, mut links, mut joins, mut ends) = (0, 0, 0, 0);
    for y in 0..grid.height() {
        for x in 0..grid.width() {
            if !hallway(x, y) {
                continue;
            }
            cells += 1;
            let here = grid.index(x, y);
            for (x, y) in [(x + 1, y), (x, y + 1)] {
                if hallway(x, y) {
                    links += 1;
                    joins += u64::from(sets.join(here, grid.index(x, y)));
                }
            }
            let neighbours =
                [(x + 1, y), (x, y + 1), (x.wrapping_sub(1), y), (x, y.wrapping_sub(1))];
            ends += u64::from(neighbours.iter().filter(|&&(x, y)| hallway(x, y)).count() < 2);
        }
    }
    HallwayShape { cells, parts: cells - joins, cycles: links - joins, ends }
}
