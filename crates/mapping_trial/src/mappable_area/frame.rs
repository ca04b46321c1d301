//! The grid of scores.

use envgen::GridFrame;
use envgen::geometry::Rect;
use glam::DVec2;

use crate::map::{CellIndex, RESOLUTION};

/// Side of a score cell in metres: two cells of a robot's map.
pub const SCORE_CELL: f64 = 2.0 * RESOLUTION;

/// A rectangle of cells of [`SCORE_CELL`], in rows from below. It is aligned with the cells of a map,
/// so that each of its cells contains four of those.
///
/// Unlike a [`GridFrame`], it counts its cells from the world's origin in integers, so that all frames
/// agree to the last bit on the cell of a point.
///
/// ```
/// use envgen::glam::DVec2;
/// use mapping_trial::mappable_area::ScoreFrame;
///
/// // Cells of 0.1 m from (-1, 2) m on.
/// let frame = ScoreFrame { col: -10, row: 20, cols: 5, rows: 3 };
/// assert_eq!(frame.cell_at(DVec2::new(-0.95, 2.15)), Some(5));
/// assert!(frame.centre(5).distance(DVec2::new(-0.95, 2.15)) < 1e-12);
/// assert_eq!(frame.cell_at(DVec2::ZERO), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScoreFrame {
    /// Column of the leftmost cells, counted from the world's origin.
    pub col: i32,
    /// Row of the lowest cells, counted from the world's origin.
    pub row: i32,
    /// Number of columns.
    pub cols: usize,
    /// Number of rows.
    pub rows: usize,
}

impl ScoreFrame {
    /// The cells that touch a rectangle, which must not be far larger than memory.
    pub(crate) fn around(area: Rect) -> Self {
        let low = (area.min / SCORE_CELL).floor();
        let size = ((area.max / SCORE_CELL).ceil() - low).max(DVec2::ONE);
        ScoreFrame {
            col: low.x as i32,
            row: low.y as i32,
            cols: size.x as usize,
            rows: size.y as usize,
        }
    }

    /// The cells that both frames have; empty if there are none.
    pub(crate) fn intersection(self, other: ScoreFrame) -> ScoreFrame {
        let (col, row) = (self.col.max(other.col), self.row.max(other.row));
        let end = |a: i32, a_len: usize, b: i32, b_len: usize, from: i32| {
            let end = (i64::from(a) + a_len as i64).min(i64::from(b) + b_len as i64);
            (end - i64::from(from)).max(0) as usize
        };
        let cols = end(self.col, self.cols, other.col, other.cols, col);
        let rows = end(self.row, self.rows, other.row, other.rows, row);
        if cols * rows == 0 {
            ScoreFrame { col, row, cols: 0, rows: 0 }
        } else {
            ScoreFrame { col, row, cols, rows }
        }
    }

    /// Returns the number of cells.
    pub fn len(self) -> usize {
        self.cols * self.rows
    }

    /// Returns whether there are no cells.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Returns the cell that contains a point in metres; `None` outside of the frame.
    pub fn cell_at(self, p: DVec2) -> Option<usize> {
        let CellIndex { col, row } = CellIndex::of(p);
        self.cell(col.div_euclid(2), row.div_euclid(2))
    }

    /// The cell of a column and a row that count from the world's origin; `None` outside of the frame.
    pub(crate) fn cell(self, col: i32, row: i32) -> Option<usize> {
        let x = usize::try_from(i64::from(col) - i64::from(self.col)).ok()?;
        let y = usize::try_from(i64::from(row) - i64::from(self.row)).ok()?;
        (x < self.cols && y < self.rows).then(|| self.grid().index(x, y))
    }

    /// Column and row of a cell, counted from the world's origin.
    pub(crate) fn place(self, cell: usize) -> (i32, i32) {
        let (col, row) = self.grid().cell(cell);
        (self.col + col as i32, self.row + row as i32)
    }

    /// Returns the centre of a cell in metres.
    pub fn centre(self, cell: usize) -> DVec2 {
        let (col, row) = self.place(cell);
        (DVec2::new(f64::from(col), f64::from(row)) + 0.5) * SCORE_CELL
    }

    /// Returns the rectangle that the cells cover, in metres.
    pub fn area(self) -> Rect {
        let low = DVec2::new(f64::from(self.col), f64::from(self.row));
        let high = low + DVec2::new(self.cols as f64, self.rows as f64);
        Rect::new(low * SCORE_CELL, high * SCORE_CELL)
    }

    /// A cell's neighbour, `x` columns to the right and `y` rows up; `None` outside.
    pub(crate) fn neighbour(self, cell: usize, x: i32, y: i32) -> Option<usize> {
        self.grid().neighbour(cell, x as isize, y as isize)
    }

    /// The same cells, counted from the lower left one.
    fn grid(self) -> GridFrame {
        let origin = DVec2::new(f64::from(self.col), f64::from(self.row)) * SCORE_CELL;
        GridFrame { origin, cell_size: SCORE_CELL, cols: self.cols, rows: self.rows }
    }
}
