//! The largest passable region of a raster, and its ends.

use glam::DVec2;

use crate::grid;
use crate::world::ClassRaster;

/// Returns the cells of the largest passable region, in which cells are joined by their sides; of equal regions,
/// the first. Their order is that of [`grid::largest_region`].
pub(crate) fn largest_region(raster: &ClassRaster) -> Vec<u32> {
    let open =
        raster.cells.iter().map(|&class| class != 0 && raster.speed_of(class) > 0.0).collect();
    grid::largest_region(raster.frame(), open)
}

/// Returns the centres of the two cells of the largest region that are nearest to the lower left and to the upper
/// right corner.
pub(super) fn ends(raster: &ClassRaster) -> Option<(DVec2, DVec2)> {
    let (frame, cols) = (raster.frame(), raster.cols as usize);
    let region = largest_region(raster);
    let rise = |&at: &u32| (i64::from(at) % cols as i64 - i64::from(at) / cols as i64, at);
    let middle = |at: u32| {
        let (col, row) = frame.cell(at as usize);
        frame.center(col, frame.rows - 1 - row)
    };
    let low = region.iter().copied().min_by_key(rise)?;
    let high = region.iter().copied().max_by_key(rise)?;
    Some((middle(low), middle(high)))
}
