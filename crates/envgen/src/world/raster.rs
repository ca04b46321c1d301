//! The grid of classes of a landscape.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::grid::GridFrame;

/// The cells of a landscape: square, row by row, with the top row (greatest y) first.
///
/// ```
/// use envgen::glam::DVec2;
/// use envgen::landscape::metrics::{Border, RasterReport};
/// use envgen::world::ClassRaster;
///
/// // Two rows of three cells of 10 m; robots drive in class 2 at half their speed.
/// let raster = ClassRaster {
///     rows: 2,
///     cols: 3,
///     cell: 10.0,
///     origin: DVec2::ZERO,
///     cells: vec![1, 1, 2, 1, 2, 2],
///     speeds: vec![0.0, 1.0, 0.5],
/// };
/// assert_eq!(raster.class_at(DVec2::new(15.0, 15.0)), Some(1));
/// assert_eq!(raster.speed_at(DVec2::new(15.0, 5.0)), Some(0.5));
/// let report = RasterReport::new(&raster, Border::Free)?;
/// assert_eq!((report.edge_count, report.total_edge_m), (3, 30.0));
/// # Ok::<(), envgen::landscape::metrics::RasterError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassRaster {
    /// Number of rows.
    pub rows: u32,
    /// Number of columns.
    pub cols: u32,
    /// Side of a cell in metres.
    pub cell: f64,
    /// Lower left corner of the raster in metres.
    pub origin: DVec2,
    /// The class of each cell, counted from 1, where 0 means no data. There are `rows * cols` cells, row by row
    /// from the top.
    pub cells: Vec<u16>,
    /// Factor on a robot's greatest speed by class, beginning with class 0 (no data). A class beyond the end of the
    /// list has factor 1; no data has factor 0 if the list is empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speeds: Vec<f64>,
}

impl ClassRaster {
    /// Returns the frame of the cells. Its rows count from the lowest, those of [`ClassRaster::cells`] from the
    /// top.
    pub fn frame(&self) -> GridFrame {
        let (cols, rows) = (self.cols as usize, self.rows as usize);
        GridFrame { origin: self.origin, cell_size: self.cell, cols, rows }
    }

    /// Returns the class at a point; `None` outside the raster.
    pub fn class_at(&self, p: DVec2) -> Option<u16> {
        let frame = self.frame();
        let (col, row) = frame.cell_at(p)?;
        self.cells.get(frame.index(col, frame.rows - 1 - row)).copied()
    }

    /// Returns the factor on a robot's greatest speed at a point, 0 where it cannot pass; `None` outside the
    /// raster.
    pub fn speed_at(&self, p: DVec2) -> Option<f64> {
        self.class_at(p).map(|class| self.speed_of(class))
    }

    /// Returns the factor on a robot's greatest speed on a class. Without a given factor it is 1, or 0 for no data.
    pub fn speed_of(&self, class: u16) -> f64 {
        let usual = if class == 0 { 0.0 } else { 1.0 };
        self.speeds.get(usize::from(class)).copied().unwrap_or(usual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_row_comes_first() {
        let raster = ClassRaster {
            rows: 2,
            cols: 3,
            cell: 2.0,
            origin: DVec2::new(-1.0, 0.0),
            cells: vec![1, 2, 3, 4, 5, 6],
            speeds: vec![0.0, 0.5],
        };
        assert_eq!(raster.class_at(DVec2::new(-0.5, 3.5)), Some(1));
        assert_eq!(raster.class_at(DVec2::new(4.5, 0.5)), Some(6));
        assert_eq!(raster.class_at(DVec2::new(5.0, 0.5)), None);
        assert_eq!(raster.class_at(DVec2::new(0.0, -0.1)), None);
        assert_eq!(raster.class_at(DVec2::new(f64::NAN, 0.0)), None);
        assert_eq!(raster.speed_at(DVec2::new(-0.5, 3.5)), Some(0.5));
        assert_eq!(raster.speed_at(DVec2::new(4.5, 0.5)), Some(1.0));
    }
}
