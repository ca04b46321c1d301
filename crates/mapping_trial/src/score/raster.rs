//! A robot's map on the grid of scores.

use crate::map::{CellIndex, DECIDED, OccupancyMap, TILE};
use crate::mappable_area::{MappableArea, ScoreFrame};

/// A robot's map on the part of the mappable area's grid that it covers.
pub(crate) struct Raster {
    /// The grid of score cells.
    pub(crate) frame: ScoreFrame,
    /// Score cells of which at least a quarter is occupied: `E_o`.
    pub(crate) occupied: Vec<bool>,
    /// Score cells that are not occupied and of which at least a quarter is free: `E_f`.
    pub(crate) free: Vec<bool>,
    /// The map's own cells that are occupied, four per score cell.
    pub(crate) fine: Vec<bool>,
    /// Occupied score cells outside the mappable area's grid.
    pub(crate) occupied_outside: usize,
}

/// Border in score cells around a map's tiles, as wide as distances between walls count.
const AROUND: i32 = 11;

/// Score cells along the side of a map's tile.
const TILE_CELLS: i32 = TILE / 2;

impl Raster {
    pub(crate) fn of(truth: &MappableArea, map: &OccupancyMap) -> Self {
        let tiles = map.tiles().map(|((col, row), _)| (col, row));
        let around = tiles.fold(None, |around: Option<[i32; 4]>, (col, row)| {
            let [left, low, right, high] = around.unwrap_or([col, row, col, row]);
            Some([left.min(col), low.min(row), right.max(col), high.max(row)])
        });
        let frame = truth.frame().intersection(match around {
            // Walls of the world beside the map can be near walls on the map.
            Some([left, low, right, high]) => ScoreFrame {
                col: left * TILE_CELLS - AROUND,
                row: low * TILE_CELLS - AROUND,
                cols: ((right - left + 1) * TILE_CELLS + 2 * AROUND) as usize,
                rows: ((high - low + 1) * TILE_CELLS + 2 * AROUND) as usize,
            },
            None => ScoreFrame { cols: 0, rows: 0, ..truth.frame() },
        });
        let mut raster = Raster {
            frame,
            occupied: vec![false; frame.len()],
            free: vec![false; frame.len()],
            fine: vec![false; 4 * frame.len()],
            occupied_outside: 0,
        };
        for ((col, row), cells) in map.tiles() {
            raster.add_tile(col, row, cells);
        }
        raster
    }

    fn add_tile(&mut self, tile_col: i32, tile_row: i32, cells: &[i16]) {
        for y in 0..TILE_CELLS {
            for x in 0..TILE_CELLS {
                let corner = (2 * y * TILE + 2 * x) as usize;
                let four = [0, 1, TILE as usize, TILE as usize + 1].map(|i| cells[corner + i]);
                let occupied = four.iter().any(|&odds| odds > DECIDED);
                let free = four.iter().any(|&odds| odds < -DECIDED);
                if !(occupied || free) {
                    continue;
                }
                let (col, row) = (tile_col * TILE_CELLS + x, tile_row * TILE_CELLS + y);
                let Some(cell) = self.frame.cell(col, row) else {
                    self.occupied_outside += usize::from(occupied);
                    continue;
                };
                self.occupied[cell] = occupied;
                self.free[cell] = !occupied;
                let fine = self.fine_corner(cell);
                for (at, odds) in
                    [0, 1, 2 * self.frame.cols, 2 * self.frame.cols + 1].into_iter().zip(four)
                {
                    self.fine[fine + at] = odds > DECIDED;
                }
            }
        }
    }

    /// Returns the lower left of the four map cells in a score cell.
    pub(crate) fn fine_corner(&self, cell: usize) -> usize {
        let (x, y) = (cell % self.frame.cols, cell / self.frame.cols);
        4 * y * self.frame.cols + 2 * x
    }

    /// Whether a cell of the map is occupied. Cells outside of the frame are not.
    pub(crate) fn is_occupied(&self, index: CellIndex) -> bool {
        let (col, row) = (index.col.div_euclid(2), index.row.div_euclid(2));
        self.frame.cell(col, row).is_some_and(|cell| {
            let (x, y) = (index.col.rem_euclid(2) as usize, index.row.rem_euclid(2) as usize);
            self.fine[self.fine_corner(cell) + 2 * self.frame.cols * y + x]
        })
    }
}
