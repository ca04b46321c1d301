//! The largest region of a raster that can be passed, and its ends.

use glam::DVec2;

use super::metrics::Neighbourhood;
use crate::world::ClassRaster;

/// The cells of the largest region that can be passed, cells joined by their sides; of equal
/// regions the first.
pub(crate) fn largest_region(raster: &ClassRaster) -> Vec<u32> {
    let (cols, total) = (raster.cols as usize, raster.cells.len());
    let mut open: Vec<bool> =
        raster.cells.iter().map(|&class| class != 0 && raster.speed_of(class) > 0.0).collect();
    let (mut best, mut region) = (Vec::new(), Vec::new());
    for start in 0..total {
        if !std::mem::take(&mut open[start]) {
            continue;
        }
        region.clear();
        region.push(start as u32);
        let mut next = 0;
        while let Some(&at) = region.get(next) {
            next += 1;
            for to in neighbours(at as usize, cols, total, Neighbourhood::Four) {
                if std::mem::take(&mut open[to]) {
                    region.push(to as u32);
                }
            }
        }
        if region.len() > best.len() {
            std::mem::swap(&mut best, &mut region);
        }
    }
    best
}

/// The middles of the two cells of the largest region that are nearest to the lower left and to
/// the upper right corner.
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

/// The neighbours of a cell of a grid of `cells` cells, the four of its sides first.
pub(super) fn neighbours(
    at: usize,
    cols: usize,
    cells: usize,
    neighbourhood: Neighbourhood,
) -> impl Iterator<Item = usize> {
    let column = at % cols;
    let (left, right) = (column > 0, column + 1 < cols);
    let (up, down) = (at >= cols, at + cols < cells);
    let corners = neighbourhood == Neighbourhood::Eight;
    [
        (left, -1),
        (right, 1),
        (up, -(cols as isize)),
        (down, cols as isize),
        (corners && up && left, -(cols as isize) - 1),
        (corners && up && right, -(cols as isize) + 1),
        (corners && down && left, cols as isize - 1),
        (corners && down && right, cols as isize + 1),
    ]
    .into_iter()
    .filter(|step| step.0)
    .map(move |(_, step)| at.wrapping_add_signed(step))
}
