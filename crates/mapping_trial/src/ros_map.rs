//! A robot's map in the form that ROS and Nav2 know.

use envgen::export::ros_map::{MAX_CELLS, RosCell, RosMap};
use envgen::geometry::Pose;
use envgen::occupancy::OccupancyError;
use glam::DVec2;

use crate::map::{DECIDED, OccupancyMap, RESOLUTION, TILE};

impl OccupancyMap {
    /// The map as a file for ROS: the smallest one around all tiles that were ever
    /// written; one unknown cell if there are no tiles.
    ///
    /// # Errors
    /// If that is more than [`MAX_CELLS`] cells.
    pub fn to_ros_map(&self) -> Result<RosMap, OccupancyError> {
        let around = self.tiles().map(|(at, _)| at).fold(None, |around, (col, row)| {
            let [left, low, right, high] = around.unwrap_or([col, row, col, row]);
            Some([left.min(col), low.min(row), right.max(col), high.max(row)])
        });
        let Some([left, low, right, high]) = around else {
            let origin = Pose::default();
            return Ok(RosMap {
                cols: 1,
                resolution: RESOLUTION,
                origin,
                cells: vec![RosCell::Unknown],
            });
        };
        let side = TILE as usize;
        let (cols, rows) = ((right - left + 1) as usize * side, (high - low + 1) as usize * side);
        if cols as u64 * rows as u64 > MAX_CELLS {
            let (cols, rows) = (cols as f64, rows as f64);
            let most = MAX_CELLS;
            return Err(OccupancyError::Size { resolution: RESOLUTION, cols, rows, most });
        }
        let mut cells = vec![RosCell::Unknown; cols * rows];
        for ((col, row), tile) in self.tiles() {
            let (x, y) = ((col - left) as usize * side, (row - low) as usize * side);
            for (i, odds) in tile.chunks_exact(side).enumerate() {
                let start = (y + i) * cols + x;
                for (cell, &odds) in cells[start..start + side].iter_mut().zip(odds) {
                    *cell = match odds {
                        odds if odds > DECIDED => RosCell::Occupied,
                        odds if odds < -DECIDED => RosCell::Free,
                        _ => RosCell::Unknown,
                    };
                }
            }
        }
        let corner = DVec2::new(f64::from(left), f64::from(low)) * (f64::from(TILE) * RESOLUTION);
        let origin = Pose { position: corner, heading: 0.0 };
        Ok(RosMap { cols, resolution: RESOLUTION, origin, cells })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{CLAMP, CellIndex};

    #[test]
    fn a_map_keeps_its_cells_and_its_place() {
        let mut map = OccupancyMap::new();
        assert_eq!(map.to_ros_map().unwrap().cells, [RosCell::Unknown]);
        map.add(CellIndex { col: -1, row: 2 }, CLAMP);
        map.add(CellIndex { col: 40, row: 2 }, -CLAMP);
        map.add(CellIndex { col: 41, row: 2 }, 10);
        let found = map.to_ros_map().unwrap();
        assert_eq!((found.cols, found.rows()), (96, 32));
        assert!(found.origin.position.distance(DVec2::new(-1.6, 0.0)) < 1e-12);
        let at = |col: usize| found.cells[2 * 96 + col];
        assert_eq!([at(31), at(72), at(73)], [RosCell::Occupied, RosCell::Free, RosCell::Unknown]);
        let known = found.cells.iter().filter(|cell| **cell != RosCell::Unknown).count();
        assert_eq!(known, 2);
        // Reading the files gives the same map.
        let (mut yaml, mut image) = (Vec::new(), Vec::new());
        found.write_yaml("map.pgm", &mut yaml).unwrap();
        found.write_pgm(&mut image).unwrap();
        let text = String::from_utf8(yaml).unwrap();
        let read = envgen::import::ros_map::RosDescription::from_yaml(&text).unwrap();
        assert_eq!(read.map(&image).unwrap(), found);
    }

    #[test]
    fn a_map_that_is_too_large_for_a_file_is_an_error() {
        let mut map = OccupancyMap::new();
        map.add(CellIndex { col: 0, row: 0 }, CLAMP);
        map.add(CellIndex { col: 50_000, row: 50_000 }, CLAMP);
        assert!(matches!(map.to_ros_map(), Err(OccupancyError::Size { .. })));
    }
}
