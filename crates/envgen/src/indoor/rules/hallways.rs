//! The rule `hallwayRule`: parallel hallways at a fixed distance, across the whole map.

use crate::indoor::grid::{Cell, Grid};

/// Fills every column whose number is a multiple of `horizontal`, and every row whose number is a multiple of
/// `vertical`.
pub(in crate::indoor) fn place(grid: &mut Grid, horizontal: u32, vertical: u32) {
    let (width, height) = (grid.width(), grid.height());
    for x in (0..width).step_by(horizontal as usize) {
        grid.fill(x, 0, 1, height, Cell::Hallway);
    }
    for y in (0..height).step_by(vertical as usize) {
        grid.fill(0, y, width, 1, Cell::Hallway);
    }
}
