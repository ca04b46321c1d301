//! The geometry of a grid of square cells.

use glam::DVec2;

use crate::geometry::Rect;

/// The position and size of a grid: equal square cells over an axis-aligned rectangle. Rasters, occupancy grids and
/// spatial indices share it.
///
/// Cell (`col`, `row`) covers `origin` + [`col`, `col` + 1) x `cell_size` in x, and likewise in y. Column 0 is the
/// leftmost, row 0 the lowest. Cells are indexed row by row: `row * cols + col`.
///
/// ```
/// use envgen::GridFrame;
/// use envgen::glam::DVec2;
///
/// let frame = GridFrame { origin: DVec2::new(-1.0, 0.0), cell_size: 0.5, cols: 4, rows: 3 };
/// assert_eq!(frame.cell_at(DVec2::new(0.2, 1.4)), Some((2, 2)));
/// assert_eq!(frame.cell_at(DVec2::new(0.2, 1.5)), None);
/// assert_eq!(frame.center(2, 2), DVec2::new(0.25, 1.25));
/// assert_eq!(frame.index(2, 2), 10);
/// assert!(frame.neighbours(10).eq([9, 11, 6]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridFrame {
    /// Lower left corner of cell (0, 0) in metres.
    pub origin: DVec2,
    /// Side of a cell in metres.
    pub cell_size: f64,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

impl GridFrame {
    /// Returns the number of cells.
    #[inline]
    pub fn len(self) -> usize {
        self.cols * self.rows
    }

    /// Returns whether there are no cells.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Returns the rectangle that the cells cover, in metres.
    pub fn bounds(self) -> Rect {
        Rect::new(self.origin, self.corner(self.cols, self.rows))
    }

    /// Returns the column and row of the cell that contains a point; `None` outside the grid, and for NaN.
    #[inline]
    pub fn cell_at(self, p: DVec2) -> Option<(usize, usize)> {
        // Not rounded down: what is cut off below does that, and many processors have no instruction for it.
        let cell = (p - self.origin) / self.cell_size;
        let inside = cell.x >= 0.0
            && cell.y >= 0.0
            && cell.x < self.cols as f64
            && cell.y < self.rows as f64;
        inside.then_some((cell.x as usize, cell.y as usize))
    }

    /// Returns the index of the cell that contains a point; `None` outside the grid, and for NaN.
    #[inline]
    pub fn index_at(self, p: DVec2) -> Option<usize> {
        self.cell_at(p).map(|(col, row)| self.index(col, row))
    }

    /// Returns the index of a cell of the grid.
    #[inline]
    pub fn index(self, col: usize, row: usize) -> usize {
        debug_assert!(col < self.cols && row < self.rows, "({col}, {row}) is not in {self:?}");
        row * self.cols + col
    }

    /// Returns the column and row of the cell with an index.
    ///
    /// # Panics
    /// When the grid has no columns.
    #[inline]
    #[track_caller]
    pub fn cell(self, index: usize) -> (usize, usize) {
        (index % self.cols, index / self.cols)
    }

    /// Returns the lower left corner of a cell in metres. `cols` and `rows` are allowed as well, and give the far
    /// borders of the grid.
    #[inline]
    pub fn corner(self, col: usize, row: usize) -> DVec2 {
        self.origin + DVec2::new(col as f64, row as f64) * self.cell_size
    }

    /// Returns the centre of a cell in metres.
    #[inline]
    pub fn center(self, col: usize, row: usize) -> DVec2 {
        self.origin + (DVec2::new(col as f64, row as f64) + 0.5) * self.cell_size
    }

    /// Returns the centre of the cell with an index, in metres.
    ///
    /// # Panics
    /// When the grid has no columns.
    #[inline]
    #[track_caller]
    pub fn center_of(self, index: usize) -> DVec2 {
        let (col, row) = self.cell(index);
        self.center(col, row)
    }

    /// Returns the cell `right` columns to the right of another cell and `up` rows above it; `None` outside the grid.
    ///
    /// # Panics
    /// When the grid has no columns.
    #[inline]
    #[track_caller]
    pub fn neighbour(self, index: usize, right: isize, up: isize) -> Option<usize> {
        let (col, row) = self.cell(index);
        let (col, row) = (col.checked_add_signed(right)?, row.checked_add_signed(up)?);
        (col < self.cols && row < self.rows).then(|| self.index(col, row))
    }

    /// Returns the cells that share a side with a cell, in the order left, right, below, above; at the border there
    /// are fewer.
    ///
    /// ```
    /// use envgen::GridFrame;
    /// use envgen::glam::DVec2;
    ///
    /// let frame = GridFrame { origin: DVec2::ZERO, cell_size: 1.0, cols: 3, rows: 2 };
    /// // The lower left corner has neighbours to the right and above.
    /// assert_eq!(frame.neighbours(0).collect::<Vec<_>>(), [1, 3]);
    /// assert_eq!(frame.neighbour(0, 1, 1), Some(4));
    /// assert_eq!(frame.neighbour(0, -1, 0), None);
    /// ```
    ///
    /// # Panics
    /// When the grid has no columns.
    #[inline]
    #[track_caller]
    pub fn neighbours(self, index: usize) -> impl Iterator<Item = usize> {
        let col = index % self.cols;
        [
            (col > 0).then(|| index - 1),
            (col + 1 < self.cols).then_some(index + 1),
            index.checked_sub(self.cols),
            Some(index + self.cols).filter(|&above| above < self.len()),
        ]
        .into_iter()
        .flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame() -> impl Strategy<Value = GridFrame> {
        (-99.0..99.0_f64, -99.0..99.0_f64, 0.01..5.0_f64, 1..9_usize, 1..9_usize).prop_map(
            |(x, y, cell_size, cols, rows)| GridFrame {
                origin: DVec2::new(x, y),
                cell_size,
                cols,
                rows,
            },
        )
    }

    #[test]
    fn borders_belong_to_the_upper_right_cell() {
        let frame = GridFrame { origin: DVec2::new(1.0, 2.0), cell_size: 0.5, cols: 2, rows: 3 };
        assert_eq!(frame.cell_at(frame.origin), Some((0, 0)));
        assert_eq!(frame.cell_at(DVec2::new(1.5, 3.0)), Some((1, 2)));
        assert_eq!(frame.cell_at(frame.bounds().max), None);
        assert_eq!(frame.cell_at(DVec2::new(f64::NAN, 2.0)), None);
        assert_eq!(GridFrame { cols: 0, ..frame }.cell_at(frame.origin), None);
    }

    proptest! {
        #[test]
        fn every_cell_holds_its_center(frame in frame()) {
            for index in 0..frame.len() {
                let (col, row) = frame.cell(index);
                prop_assert_eq!(frame.index(col, row), index);
                prop_assert_eq!(frame.index_at(frame.center_of(index)), Some(index));
                let middle = 0.5 * (frame.corner(col, row) + frame.corner(col + 1, row + 1));
                prop_assert!(frame.center(col, row).distance(middle) < 1e-12);
            }
        }

        #[test]
        fn points_of_the_bounds_are_in_a_cell(
            frame in frame(), x in -0.5..1.5_f64, y in -0.5..1.5_f64,
        ) {
            let bounds = frame.bounds();
            let p = bounds.min + bounds.size() * DVec2::new(x, y);
            let margin = 1e-9;
            match frame.cell_at(p) {
                Some((col, row)) => {
                    let cell = Rect::new(frame.corner(col, row), frame.corner(col + 1, row + 1));
                    prop_assert!(cell.grown(margin).contains(p));
                }
                None => prop_assert!(!bounds.grown(-margin).contains(p)),
            }
        }

        #[test]
        fn neighbours_share_a_side(frame in frame(), cell in any::<prop::sample::Index>()) {
            let cell = cell.index(frame.len());
            let sides = [(-1, 0), (1, 0), (0, -1), (0, 1)];
            let expected = sides.into_iter().filter_map(|(x, y)| frame.neighbour(cell, x, y));
            prop_assert!(frame.neighbours(cell).eq(expected));
            let (col, row) = frame.cell(cell);
            for other in frame.neighbours(cell) {
                let (x, y) = frame.cell(other);
                prop_assert_eq!(x.abs_diff(col) + y.abs_diff(row), 1);
            }
        }
    }
}
