//! The second adaptation: cells that the rooms leave empty become open area.

use crate::indoor::grid::{Cell, Grid};

/// Turns every solid cell into open area, except cells that the prevention of cycles took from the hallways and no
/// room took. These remain solid, because otherwise the cycles would close again.
pub(in crate::indoor) fn fill(grid: &mut Grid, removed: &[(u32, u32)]) {
    let blocked: Vec<usize> = removed
        .iter()
        .filter(|&&(x, y)| grid.at(x, y) == Cell::Solid)
        .map(|&(x, y)| grid.index(x, y))
        .collect();
    for index in 0..grid.cells().len() {
        if grid.cells()[index] == Cell::Solid {
            grid.set_index(index, Cell::Open);
        }
    }
    for index in blocked {
        grid.set_index(index, Cell::Solid);
    }
}
