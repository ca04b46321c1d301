//! Start poses for worlds from files that have none.

use crate::flood::flood;
use crate::geometry::{Pose, Rect};
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::placement::max_clearance_point;
use crate::world::World;

/// Side in metres of a cell of the grid on which a start is searched, unless the world is large.
const CELL: f64 = 0.05;

/// Approximate greatest number of cells of that grid.
const MOST_CELLS: f64 = 2.5e5;

/// Returns the place of greatest clearance in the largest free region; `None` if nothing is free. If it must be
/// `enclosed`, only regions count that walls separate from the world's bounds.
pub(super) fn start_of_most_clearance(world: &World, enclosed: bool) -> Option<Pose> {
    let size = world.bounds.size();
    // Along the longer side too there are not more cells than that.
    let least = (size.x * size.y / MOST_CELLS).sqrt().max(size.max_element() / MOST_CELLS);
    let grid = OccupancyGrid::of(world, CELL.max(least), Coverage::Conservative).ok()?;
    let frame = grid.frame();
    let mut cells = grid.cells().to_vec();
    if enclosed {
        let mut open: Vec<bool> = cells.iter().map(|occupied| !occupied).collect();
        let (rows, cols) = (frame.rows, frame.cols);
        let ends = (0..rows).flat_map(|row| [row * cols, row * cols + cols - 1]);
        for cell in ends.chain(0..cols).chain((rows - 1) * cols..rows * cols) {
            flood(cols, &mut open, cell, |run| cells[run].fill(true));
        }
    }
    let grid = OccupancyGrid::from_cells(frame.origin, frame.cell_size, frame.cols, cells).ok()?;
    // The last cells may reach beyond the bounds.
    let Rect { min, max } = world.bounds;
    let position = max_clearance_point(&grid)?.clamp(min, max);
    (world.clearance(position) > 0.0).then_some(Pose { position, heading: 0.0 })
}
