//! Maps in messages of drivers: cells as in ROS's `OccupancyGrid`, in base64.

use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use envgen::export::ros_map::RosCell;
use envgen::geometry::Rect;
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::error::{DriverError, not_allowed};
use super::limits::MAX_LINE;
use crate::map::{CLAMP, OccupancyMap, RESOLUTION, TIE, TILE};

/// Cells as bytes: the probability of being occupied in percent; 255 (-1 as a signed byte) is unknown.
const FREE: u8 = 0;
const OCCUPIED: u8 = 100;
const UNKNOWN: u8 = 255;

/// Percentages from which a cell counts as occupied, and up to which as free, as in [`OccupancyMap`].
const SURELY_OCCUPIED: u8 = 65;
const SURELY_FREE: u8 = 35;

/// Least and greatest side in metres of a cell of a driver's map.
const FINEST: f64 = 0.01;
const COARSEST: f64 = 1.0;

/// Largest side of a driver's map in metres.
const LARGEST: f64 = 400.0;

/// Greatest number of cells of a driver's map: those of 0.05 m in the largest one. In base64 they fit into a line.
const MOST_CELLS: u64 = 64_000_000;
const _: () = assert!(MOST_CELLS as usize / 3 * 4 < MAX_LINE);

/// How far in metres a driver's map may reach from the first robot's start.
const FARTHEST: f64 = 1000.0;

/// A map in a message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object")]
pub(super) struct Grid {
    /// The lower left corner of the first cell in metres.
    origin: [f64; 2],
    /// Side of a cell in metres.
    resolution: f64,
    cols: u32,
    rows: u32,
    /// Base64 of one byte per cell, row by row from the lowest.
    cells: String,
}

impl Grid {
    /// Encodes a map for a driver.
    pub(super) fn of(map: &OccupancyMap) -> Result<Grid, DriverError> {
        let map = map.to_ros_map().map_err(|error| DriverError::MapSize(error.to_string()))?;
        let byte = |cell: &RosCell| match cell {
            RosCell::Unknown => UNKNOWN,
            RosCell::Free => FREE,
            RosCell::Occupied => OCCUPIED,
        };
        let cells: Vec<u8> = map.cells.iter().map(byte).collect();
        Ok(Grid {
            origin: map.origin.position.into(),
            resolution: map.resolution,
            cols: map.cols as u32,
            rows: map.rows() as u32,
            cells: BASE64.encode(cells),
        })
    }

    /// Returns a driver's map, resampled to our own cells. `start` is where the first robot started.
    pub(super) fn to_map(&self, start: DVec2) -> Result<OccupancyMap, DriverError> {
        let area = self.check(start)?;
        let cells = BASE64
            .decode(&self.cells)
            .map_err(|error| not_allowed("map.cells", error, "base64 with padding"))?;
        let count = self.cols as usize * self.rows as usize;
        if cells.len() != count {
            let bytes = format!("{} bytes", cells.len());
            return Err(not_allowed("map.cells", bytes, format!("{count}, one per cell")));
        }
        if let Some(bad) = cells.iter().find(|&&cell| cell > OCCUPIED && cell != UNKNOWN) {
            let allowed = "from 0 to 100, or 255 for unknown";
            return Err(not_allowed("map.cells", format!("{bad} in a cell"), allowed));
        }
        Ok(self.draw(&cells, area))
    }

    /// Returns the area of the map in metres, or names the first value that is not allowed.
    fn check(&self, start: DVec2) -> Result<Rect, DriverError> {
        let Grid { origin, resolution, cols, rows, .. } = *self;
        if !(FINEST..=COARSEST).contains(&resolution) {
            let allowed = format!("from {FINEST} to {COARSEST} m");
            return Err(not_allowed("map.resolution", resolution, allowed));
        }
        for (field, count) in [("map.cols", cols), ("map.rows", rows)] {
            let most = (LARGEST / resolution) as u32;
            if !(1..=most).contains(&count) {
                let allowed = format!("from 1 to {most}, {LARGEST} m of {resolution} m");
                return Err(not_allowed(field, count, allowed));
            }
        }
        if u64::from(cols) * u64::from(rows) > MOST_CELLS {
            let allowed = format!("at most {MOST_CELLS} cells");
            return Err(not_allowed("map.cols", format!("{cols} in {rows} rows"), allowed));
        }
        let low = DVec2::from(origin);
        let high = low + DVec2::new(f64::from(cols), f64::from(rows)) * resolution;
        let places =
            [("map.origin[0]", low.x, high.x, start.x), ("map.origin[1]", low.y, high.y, start.y)];
        for (field, low, high, start) in places {
            if !(low >= start - FARTHEST && high <= start + FARTHEST) {
                let allowed = format!("a map within {FARTHEST} m of the first robot's start");
                return Err(not_allowed(field, low, allowed));
            }
        }
        Ok(Rect::new(low, high))
    }

    fn draw(&self, cells: &[u8], area: Rect) -> OccupancyMap {
        let columns = self.strips(area.min.x, area.max.x, self.cols);
        let rows = self.strips(area.min.y, area.max.y, self.rows);
        let mut map = OccupancyMap::new();
        let mut tile = Vec::new();
        for (row, rows) in &rows {
            for (col, columns) in &columns {
                tile.clear();
                let places = rows.iter().flat_map(|row| columns.iter().map(move |col| (row, col)));
                tile.extend(places.map(|(row, col)| self.odds(cells, row.clone(), col.clone())));
                if tile.iter().any(|&odds| odds != 0)
                    && let Some(place) = map.tile_mut(*col, *row)
                {
                    place.copy_from_slice(&tile);
                }
            }
        }
        map
    }

    /// Returns, along one axis, the tiles of our map from `low` to `high`, and for each of their cells
    /// which of the grid's `count` cells it samples. A cell takes as many evenly spaced samples as the
    /// grid has cells across it, so that no thin wall of a finer grid is lost.
    fn strips(&self, low: f64, high: f64, count: u32) -> Vec<(i32, Vec<Range<usize>>)> {
        let looks = (RESOLUTION / self.resolution - 1e-9).ceil().max(1.0);
        let at = |place: f64| {
            ((place - low) / self.resolution + TIE).floor().clamp(-1.0, f64::from(count))
        };
        let span = |cell: i32| {
            let corner = f64::from(cell) * RESOLUTION;
            let first = at(corner + 0.5 / looks * RESOLUTION).max(0.0);
            let last = at(corner + (1.0 - 0.5 / looks) * RESOLUTION).min(f64::from(count) - 1.0);
            first as usize..(last + 1.0).max(first) as usize
        };
        let side = f64::from(TILE) * RESOLUTION;
        let tiles = (low / side).floor() as i32..=(high / side).floor() as i32;
        tiles.map(|tile| (tile, (tile * TILE..(tile + 1) * TILE).map(span).collect())).collect()
    }

    /// Returns the log odds of one of our cells that samples these rows and columns: occupied if any
    /// sample is occupied, otherwise free if any sample is free.
    fn odds(&self, cells: &[u8], rows: Range<usize>, columns: Range<usize>) -> i16 {
        let mut odds = 0;
        for row in rows {
            let start = row * self.cols as usize;
            for &cell in &cells[start + columns.start..start + columns.end] {
                match cell {
                    SURELY_OCCUPIED..=OCCUPIED => return CLAMP,
                    FREE..=SURELY_FREE => odds = -CLAMP,
                    _ => {}
                }
            }
        }
        odds
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::map::{Cell, CellIndex};

    fn drawn(grid: &Grid) -> Result<OccupancyMap, DriverError> {
        grid.to_map(DVec2::ZERO)
    }

    fn grid(resolution: f64, cols: u32, cells: &[u8]) -> Grid {
        let rows = cells.len() as u32 / cols;
        Grid { origin: [0.0, 0.0], resolution, cols, rows, cells: BASE64.encode(cells) }
    }

    fn known(map: &OccupancyMap) -> Vec<(CellIndex, Cell)> {
        let tiles = map.tiles().flat_map(|((col, row), _)| {
            (0..TILE * TILE)
                .map(move |i| CellIndex { col: col * TILE + i % TILE, row: row * TILE + i / TILE })
        });
        let cells = tiles.map(|at| (at, map.cell(at)));
        let mut known: Vec<_> = cells.filter(|(_, cell)| *cell != Cell::Unknown).collect();
        // Tiles come in the order of their creation.
        known.sort_by_key(|(at, _)| (at.row, at.col));
        known
    }

    proptest! {
        #[test]
        fn a_map_goes_through_a_line_unchanged(
            cells in proptest::collection::vec((-80..80_i32, -80..80_i32, any::<bool>()), 1..60),
        ) {
            let mut map = OccupancyMap::new();
            for &(col, row, wall) in &cells {
                map.add(CellIndex { col, row }, if wall { CLAMP } else { -CLAMP });
            }
            let line = serde_json::to_string(&Grid::of(&map).unwrap()).unwrap();
            let read: Grid = serde_json::from_str(&line).unwrap();
            prop_assert_eq!(known(&drawn(&read).unwrap()), known(&map));
        }

        #[test]
        fn any_numbers_are_a_map_or_an_error(
            x in any::<f64>(), y in any::<f64>(), resolution in any::<f64>(),
            cols in any::<u32>(), rows in any::<u32>(), bytes in 0..400_usize,
        ) {
            let cells = BASE64.encode(vec![0; bytes]);
            let grid = Grid { origin: [x, y], resolution, cols, rows, cells };
            prop_assert!(drawn(&grid).is_err() || (cols * rows) as usize == bytes);
        }

        #[test]
        fn coarse_and_fine_cells_cover_the_same_ground(
            resolution in FINEST..COARSEST, x in -5.0..5.0_f64, y in -5.0..5.0_f64,
            cols in 1..40_u32, rows in 1..40_u32,
        ) {
            let cells = vec![OCCUPIED; (cols * rows) as usize];
            let grid = Grid { origin: [x, y], ..grid(resolution, cols, &cells) };
            let map = drawn(&grid).unwrap();
            let low = DVec2::new(x, y);
            let high = low + DVec2::new(f64::from(cols), f64::from(rows)) * resolution;
            let area = Rect::new(low, high);
            for (at, _) in known(&map) {
                prop_assert!(area.grown(0.5 * RESOLUTION).contains(at.centre()));
            }
            for i in 0..100 {
                let along = DVec2::new(f64::from(i % 10), f64::from(i / 10)) / 9.0;
                let index = CellIndex::of(low + (high - low) * along);
                if area.contains(index.centre()) {
                    prop_assert_eq!(map.cell(index), Cell::Occupied);
                }
            }
        }
    }

    #[test]
    fn thin_walls_of_a_grid_that_is_half_a_cell_off_stay() {
        for (resolution, offset) in [(0.05, 3.575), (0.05, -51.225), (0.025, 1.0125)] {
            let mut cells = vec![FREE; 400];
            cells.iter_mut().step_by(8).for_each(|cell| *cell = OCCUPIED);
            let grid = Grid { origin: [offset, 0.0], ..grid(resolution, 400, &cells) };
            let map = drawn(&grid).unwrap();
            let walls = known(&map).iter().filter(|(_, cell)| *cell == Cell::Occupied).count();
            assert_eq!(walls, 50, "{resolution} {offset}");
        }
    }

    #[test]
    fn a_thin_wall_of_a_fine_grid_stays() {
        let mut cells = vec![FREE; 100 * 50];
        for row in 0..50 {
            cells[row * 100 + 37] = OCCUPIED;
        }
        let map = drawn(&grid(0.01, 100, &cells)).unwrap();
        for row in 0..10 {
            assert_eq!(map.cell(CellIndex { col: 7, row }), Cell::Occupied);
            assert_eq!(map.cell(CellIndex { col: 8, row }), Cell::Free);
        }
    }

    #[test]
    fn percentages_are_free_unknown_or_occupied() {
        let map = drawn(&grid(RESOLUTION, 6, &[0, 35, 36, 64, 65, 255])).unwrap();
        let found = [0, 1, 2, 3, 4, 5].map(|col| map.cell(CellIndex { col, row: 0 }));
        let (free, unknown) = (Cell::Free, Cell::Unknown);
        assert_eq!(found, [free, free, unknown, unknown, Cell::Occupied, unknown]);
    }

    #[test]
    fn maps_follow_one_another() {
        let mut map = drawn(&grid(RESOLUTION, 1, &[100])).unwrap();
        let before = map.revision();
        let far = Grid { origin: [9.0, 9.0], ..grid(RESOLUTION, 1, &[100]) };
        map.replace(drawn(&far).unwrap());
        assert!(map.revision() > before);
        assert_eq!(map.changed_since(before).count(), 1);
        assert_eq!(known(&map).len(), 1);
    }

    #[test]
    fn wrong_shapes_are_named() {
        let error = |grid: &Grid| drawn(grid).unwrap_err().to_string();
        let good = grid(0.1, 2, &[0, 0, 0, 0]);
        assert!(drawn(&good).is_ok());
        let text = error(&Grid { resolution: 0.0, ..good.clone() });
        assert_eq!(text, "`map.resolution` must be from 0.01 to 1 m, got 0");
        let text = error(&Grid { cols: 3, ..good.clone() });
        assert_eq!(text, "`map.cells` must be 6, one per cell, got 4 bytes");
        let text = error(&Grid { cols: 4_000_000_000, ..good.clone() });
        assert_eq!(text, "`map.cols` must be from 1 to 4000, 400 m of 0.1 m, got 4000000000");
        let text = error(&Grid { resolution: 0.02, cols: 8001, rows: 8000, ..good.clone() });
        assert_eq!(text, "`map.cols` must be at most 64000000 cells, got 8001 in 8000 rows");
        let text = error(&Grid { origin: [0.0, 2e3], ..good.clone() });
        assert!(text.starts_with("`map.origin[1]` must be a map within 1000 m"), "{text}");
        assert!(error(&Grid { cells: "???".to_owned(), ..good }).contains("`map.cells`"));
        assert!(error(&grid(0.1, 1, &[101])).contains("101 in a cell"));
    }
}
