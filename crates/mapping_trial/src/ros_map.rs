//! Conversion between occupancy maps and the map files of ROS and Nav2.

use envgen::export::ros_map::{MAX_CELLS, RosCell, RosMap};
use envgen::geometry::{Pose, Rect};
use envgen::occupancy::OccupancyError;
use glam::DVec2;

use crate::map::{
    CLAMP, CellIndex, DECIDED, MAX_TILES, MapError, OccupancyMap, RESOLUTION, TIE, TILE,
};

/// How much finer than [`RESOLUTION`] a map may be and still count as equal, since files round.
const AS_FINE: f64 = 1.0 - 1e-6;

/// The greatest length in metres of a side of a map. Cells farther out would be lost.
const MAX_LENGTH: f64 = MAX_TILES as f64 * TILE as f64 * RESOLUTION;

/// The greatest coordinate in metres, up to which indices of cells are exact.
const MAX_DISTANCE: f64 = 1e8;

impl OccupancyMap {
    /// Returns the smallest ROS map around all tiles that were ever written, or one unknown cell if
    /// there are no tiles. Its cells are those of the map; if there would be more than [`MAX_CELLS`],
    /// as for maps of more than 400 x 400 m, they are 2, 4, ... times as wide.
    ///
    /// ```
    /// use envgen::geometry::Pose;
    /// use mapping_trial::map::{Cell, CellIndex, HIT, OccupancyMap};
    ///
    /// let (mut map, wall) = (OccupancyMap::new(), CellIndex { col: 3, row: -4 });
    /// map.add(wall, HIT);
    /// let file = map.to_ros_map()?;
    /// // Whole tiles of 32 x 32 cells of 5 cm.
    /// assert_eq!((file.cols, file.rows(), file.resolution), (32, 32, 0.05));
    /// let read = OccupancyMap::from_ros_map(&file, Pose::default())?;
    /// assert_eq!(read.cell(wall), Cell::Occupied);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    /// # Errors
    ///
    /// If the map has more than [`MAX_CELLS`] cells.
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
        let tiles = [right - left + 1, high - low + 1].map(|tiles| tiles as u64);
        // Cells of the file along a tile, and how often those of the map are doubled.
        let (mut side, mut doublings) = (u64::from(TILE.unsigned_abs()), 0);
        let size = |side: u64| tiles.map(|tiles| tiles * side);
        let fits = |[cols, rows]: [u64; 2]| cols * rows <= MAX_CELLS;
        while side > 1 && !fits(size(side)) {
            (side, doublings) = (side / 2, doublings + 1);
        }
        let resolution = RESOLUTION * f64::from(1_u32 << doublings);
        if !fits(size(side)) {
            let [cols, rows] = size(side).map(|count| count as f64);
            return Err(OccupancyError::Size { resolution, cols, rows, most: MAX_CELLS });
        }
        let [cols, rows] = size(side).map(|count| count as usize);
        let side = side as usize;
        let mut cells = vec![RosCell::Unknown; cols * rows];
        for ((col, row), tile) in self.tiles() {
            let (x, y) = ((col - left) as usize * side, (row - low) as usize * side);
            for (i, odds) in tile.chunks_exact(TILE as usize).enumerate() {
                let start = (y + (i >> doublings)) * cols + x;
                for (j, &odds) in odds.iter().enumerate() {
                    let cell = &mut cells[start + (j >> doublings)];
                    // A wall in a part of a cell fills it.
                    *cell = match odds {
                        odds if odds > DECIDED => RosCell::Occupied,
                        odds if odds < -DECIDED && *cell == RosCell::Unknown => RosCell::Free,
                        _ => *cell,
                    };
                }
            }
        }
        let corner = DVec2::new(f64::from(left), f64::from(low)) * (f64::from(TILE) * RESOLUTION);
        let origin = Pose { position: corner, heading: 0.0 };
        Ok(RosMap { cols, resolution, origin, cells })
    }

    /// Converts a ROS map into the world's frame, where `frame` is the pose of the map's own frame in
    /// the world's.
    ///
    /// A cell takes the value that the ROS map has at the cell's middle. If the cells of the ROS map
    /// are finer, a cell is occupied if it contains the middle of an occupied one, otherwise free if it
    /// contains that of a free one. Maps that [`OccupancyMap::to_ros_map`] returns come back as they
    /// were, in the frame [`Pose::default`].
    ///
    /// # Errors
    ///
    /// If the map would have more than [`MAX_CELLS`] cells, if a side would be longer than maps can be,
    /// which is 6553.6 m, or if the map would be more than 100,000 km from the origin.
    pub fn from_ros_map(map: &RosMap, frame: Pose) -> Result<Self, MapError> {
        let place = frame.compose(map.origin);
        let size = DVec2::new(map.cols as f64, map.rows() as f64) * map.resolution;
        let corners =
            [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|c| place.to_world(c * size));
        let Some(area) = Rect::around(corners) else { return Ok(OccupancyMap::new()) };
        let [cols, rows] = (area.size() / RESOLUTION + 1.0).to_array();
        let fits = cols * rows <= MAX_CELLS as f64;
        if !fits {
            let [width, height] = area.size().to_array();
            let most = MAX_CELLS as f64 * RESOLUTION * RESOLUTION;
            return Err(MapError::Area { width, height, most });
        }
        check_sides(area, 0.5 * map.resolution.min(RESOLUTION))?;
        let mut found = OccupancyMap::new();
        if map.resolution < AS_FINE * RESOLUTION {
            found.draw_fine(map, place);
        } else {
            found.draw_coarse(map, place, area);
        }
        found.touch(area);
        Ok(found)
    }

    /// Draws a map whose cells are smaller: each of them sets the cell that contains its middle.
    fn draw_fine(&mut self, map: &RosMap, place: Pose) {
        let to_world = place.local_to_world();
        // Twice the greatest change makes occupied what was drawn as free.
        for (wanted, change) in [(RosCell::Free, -CLAMP), (RosCell::Occupied, 2 * CLAMP)] {
            for (i, _) in map.cells.iter().enumerate().filter(|(_, cell)| **cell == wanted) {
                let middle = DVec2::new((i % map.cols) as f64, (i / map.cols) as f64) + 0.5;
                self.add(CellIndex::of(to_world(middle * map.resolution)), change);
            }
        }
    }

    /// Draws a map whose cells are as large or larger: each cell takes the value at its middle.
    fn draw_coarse(&mut self, map: &RosMap, place: Pose, area: Rect) {
        let to_map = place.world_to_local();
        let step = (to_map(DVec2::X) - to_map(DVec2::ZERO)) * (RESOLUTION / map.resolution);
        let size = DVec2::new(map.cols as f64, map.rows() as f64);
        let (low, high) = (CellIndex::of(area.min), CellIndex::of(area.max));
        for row in low.row..=high.row {
            let mut col = low.col;
            while col <= high.col {
                let within = to_map(CellIndex { col, row }.centre()) / map.resolution + TIE;
                let at = within.floor();
                let end = high.col.min(col.saturating_add(steps_inside(within - at, step)));
                let inside = at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all();
                let change =
                    match inside.then(|| map.cells[at.y as usize * map.cols + at.x as usize]) {
                        Some(RosCell::Free) => -CLAMP,
                        Some(RosCell::Occupied) => CLAMP,
                        Some(RosCell::Unknown) | None => 0,
                    };
                if change != 0 {
                    (col..=end).for_each(|col| self.add(CellIndex { col, row }, change));
                }
                let Some(next) = end.checked_add(1) else { break };
                col = next;
            }
        }
    }
}

/// Checks that tiles can hold all cells of an area. Middles of cells have at least a distance of `inset`
/// metres from its sides.
fn check_sides(area: Rect, inset: f64) -> Result<(), MapError> {
    let distance = area.min.abs().max(area.max.abs()).max_element();
    if distance.is_nan() || distance > MAX_DISTANCE {
        return Err(MapError::Far { distance, most: MAX_DISTANCE });
    }
    let [low, high] = [area.min + inset, area.max - inset].map(CellIndex::of);
    let tiles = |low: i32, high: i32| {
        i64::from(high.div_euclid(TILE)) - i64::from(low.div_euclid(TILE)) + 1
    };
    let sides =
        [("width", low.col, high.col, area.size().x), ("height", low.row, high.row, area.size().y)];
    for (side, low, high, length) in sides {
        if tiles(low, high) > MAX_TILES {
            return Err(MapError::Side { side, length, most: MAX_LENGTH });
        }
    }
    Ok(())
}

/// The number of steps from a point that certainly stay inside the unit square. It is one less than
/// exact arithmetic would allow, because of rounding.
fn steps_inside(at: DVec2, step: DVec2) -> i32 {
    let along = |at: f64, step: f64| if step < 0.0 { at / -step } else { (1.0 - at) / step };
    let most = along(at.x, step.x).min(along(at.y, step.y));
    (most - 1.0).max(0.0) as i32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::map::Cell;

    fn cell() -> impl Strategy<Value = RosCell> {
        prop_oneof![Just(RosCell::Unknown), Just(RosCell::Free), Just(RosCell::Occupied)]
    }

    fn as_cell(cell: RosCell) -> Cell {
        match cell {
            RosCell::Unknown => Cell::Unknown,
            RosCell::Free => Cell::Free,
            RosCell::Occupied => Cell::Occupied,
        }
    }

    proptest! {
        #[test]
        fn a_map_comes_back_as_it_was(
            changes in proptest::collection::vec((-200..200_i32, -200..200_i32, any::<bool>()), 0..80),
        ) {
            let mut map = OccupancyMap::new();
            for &(col, row, occupied) in &changes {
                map.add(CellIndex { col, row }, if occupied { CLAMP } else { -CLAMP });
            }
            let ros = map.to_ros_map().unwrap();
            let found = OccupancyMap::from_ros_map(&ros, Pose::default()).unwrap();
            for (col, row, _) in changes {
                let index = CellIndex { col, row };
                prop_assert_eq!(found.cell(index), map.cell(index));
            }
            prop_assert_eq!(found.to_ros_map().unwrap().cells.iter().filter(|c| **c != RosCell::Unknown).count(),
                            ros.cells.iter().filter(|c| **c != RosCell::Unknown).count());
        }

        /// The middle of every cell of the map shows what the cell has, unless a finer one beside it is occupied.
        #[test]
        fn maps_of_any_resolution_and_frame_keep_their_cells(
            cells in proptest::collection::vec(cell(), 12),
            resolution in prop_oneof![Just(0.05), Just(0.1), 0.06..0.5_f64],
            x in -20.0..20.0_f64, y in -20.0..20.0_f64, heading in -3.1..3.1_f64,
        ) {
            let frame = Pose::new(x, y, heading);
            let origin = Pose::new(0.3, -0.7, 0.2);
            let map = RosMap { cols: 4, resolution, origin, cells };
            let found = OccupancyMap::from_ros_map(&map, frame).unwrap();
            let place = frame.compose(origin);
            for (i, &cell) in map.cells.iter().enumerate() {
                let middle = DVec2::new((i % 4) as f64 + 0.5, (i / 4) as f64 + 0.5) * resolution;
                let index = CellIndex::of(place.to_world(middle));
                // Half a diagonal of a target cell away, a smaller cell's neighbour may begin.
                let of = (place.to_local(index.centre()) / resolution + TIE).floor();
                let at = (of.y as usize * 4).checked_add(of.x as usize);
                let inside = of.x >= 0.0 && of.y >= 0.0 && of.x < 4.0 && of.y < 3.0;
                let expected = at.filter(|_| inside).map_or(Cell::Unknown, |at| as_cell(map.cells[at]));
                prop_assert_eq!(found.cell(index), expected);
                if resolution > 0.0708 {
                    prop_assert_eq!(found.cell(index), as_cell(cell));
                }
            }
        }

        /// A row is drawn in runs of cells that one cell of the map covers.
        #[test]
        fn coarse_maps_are_drawn_as_cell_by_cell(
            cells in proptest::collection::vec(cell(), 12), resolution in 0.05..4.0_f64,
            heading in prop_oneof![Just(0.0), Just(std::f64::consts::FRAC_PI_2), -3.1..3.1_f64],
            x in -20.0..20.0_f64,
        ) {
            let map = RosMap { cols: 4, resolution, origin: Pose::new(0.3, x, heading), cells };
            let found = OccupancyMap::from_ros_map(&map, Pose::default()).unwrap();
            let size = DVec2::new(4.0, 3.0);
            let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
            let area = Rect::around(corners.map(|c| map.origin.to_world(c * size * resolution))).unwrap();
            let (low, high) = (CellIndex::of(area.min), CellIndex::of(area.max));
            for row in low.row..=high.row {
                for col in low.col..=high.col {
                    let index = CellIndex { col, row };
                    let at = (map.origin.to_local(index.centre()) / resolution + TIE).floor();
                    let inside = at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all();
                    let wanted = inside.then(|| map.cells[at.y as usize * 4 + at.x as usize]);
                    prop_assert_eq!(found.cell(index), wanted.map_or(Cell::Unknown, as_cell));
                }
            }
        }

        #[test]
        fn finer_maps_lose_no_wall(
            cells in proptest::collection::vec(cell(), 100), resolution in 0.005..0.049_f64,
            heading in -3.1..3.1_f64,
        ) {
            let frame = Pose::new(1.0, 2.0, heading);
            let map = RosMap { cols: 10, resolution, origin: Pose::default(), cells };
            let found = OccupancyMap::from_ros_map(&map, frame).unwrap();
            for (i, &cell) in map.cells.iter().enumerate() {
                let middle = DVec2::new((i % 10) as f64 + 0.5, (i / 10) as f64 + 0.5) * resolution;
                let at = found.cell(CellIndex::of(frame.to_world(middle)));
                match cell {
                    RosCell::Occupied => prop_assert_eq!(at, Cell::Occupied),
                    RosCell::Free => prop_assert_ne!(at, Cell::Unknown),
                    RosCell::Unknown => {}
                }
            }
        }
    }

    #[test]
    fn a_map_that_is_half_a_cell_off_keeps_all_its_cells() {
        for offset in [0.025, 3.575, -3.575, -10.025, -51.225, 1000.475] {
            let mut cells = vec![RosCell::Free; 400];
            cells.iter_mut().step_by(7).for_each(|cell| *cell = RosCell::Occupied);
            for cols in [400, 1] {
                let origin = Pose::new(offset, offset, 0.0);
                let map = RosMap { cols, resolution: RESOLUTION, origin, cells: cells.clone() };
                let found = OccupancyMap::from_ros_map(&map, Pose::default()).unwrap();
                let mut drawn = found.to_ros_map().unwrap().cells;
                drawn.retain(|cell| *cell != RosCell::Unknown);
                assert!(drawn == cells, "{offset}");
            }
        }
    }

    #[test]
    fn a_map_of_ros_that_is_too_large_is_an_error() {
        let map = RosMap {
            cols: 1,
            resolution: 1000.0,
            origin: Pose::default(),
            cells: vec![RosCell::Free],
        };
        let error = OccupancyMap::from_ros_map(&map, Pose::default()).unwrap_err();
        let expected = "the area of the map must be at most 167772 m^2, got 1000.0 m x 1000.0 m";
        assert_eq!(error.to_string(), expected);
    }

    /// A free map of one row, or of one column.
    fn line(cells: usize, resolution: f64, is_column: bool) -> RosMap {
        let cols = if is_column { 1 } else { cells };
        RosMap { cols, resolution, origin: Pose::default(), cells: vec![RosCell::Free; cells] }
    }

    #[test]
    fn maps_that_are_too_far_away_are_refused() {
        let map = line(100, 0.05, false);
        for (x, is_near) in [(9e7, true), (2e8, false), (-2e8, false), (1e30, false)] {
            let found = OccupancyMap::from_ros_map(&map, Pose::new(x, 0.0, 0.0));
            let is_far = matches!(found, Err(MapError::Far { .. }));
            assert_eq!((found.is_ok(), is_far), (is_near, !is_near), "{x}");
        }
    }

    #[test]
    fn a_side_that_is_too_long_is_named() {
        for (is_column, side) in [(false, "width"), (true, "height")] {
            let map = line(20_000, 1.0, is_column);
            let error = OccupancyMap::from_ros_map(&map, Pose::default()).unwrap_err();
            let (length, most) = (20_000.0, 6553.6);
            assert_eq!(error, MapError::Side { side, length, most });
            let text = format!(
                "the {side} of the map must be at most 6553.6 m in whole tiles, got 20000.0 m"
            );
            assert_eq!(error.to_string(), text);
        }
        // The longest maps come back as they were.
        let mut map = OccupancyMap::new();
        let farthest = MAX_TILES as i32 * TILE - 1;
        for at in [-40, farthest - 64] {
            map.add(CellIndex { col: at, row: 3 }, CLAMP);
        }
        let found =
            OccupancyMap::from_ros_map(&map.to_ros_map().unwrap(), Pose::default()).unwrap();
        for col in [-40, -39, farthest - 64] {
            let index = CellIndex { col, row: 3 };
            assert_eq!(found.cell(index), map.cell(index), "{col}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn no_cell_is_lost_silently(
            length in 6400.0..6700.0_f64, resolution in prop_oneof![Just(0.05), 0.03..4.0_f64],
            start in -7000.0..2000.0_f64, is_column: bool,
        ) {
            let map = line((length / resolution) as usize, resolution, is_column);
            let frame = Pose::new(start, start, 0.0);
            let length = map.cells.len() as f64 * resolution;
            match OccupancyMap::from_ros_map(&map, frame) {
                Ok(found) => {
                    prop_assert!(length < 6553.7, "{}", length);
                    for i in 0..map.cells.len() {
                        let along = (i as f64 + 0.5) * resolution;
                        let (x, y) = if is_column { (0.0, along) } else { (along, 0.0) };
                        let half = 0.5 * resolution;
                        let middle = frame.to_world(DVec2::new(x.max(half), y.max(half)));
                        // Cells of 5 cm may have their middle beside a row that is thinner.
                        if resolution > 0.1 {
                            prop_assert_eq!(found.cell(CellIndex::of(middle)), Cell::Free);
                        }
                    }
                }
                Err(error) => {
                    let is_side = matches!(error, MapError::Side { .. });
                    // A tile on either side may be part of the map and of something else.
                    prop_assert!(is_side && length > 6553.6 - 2.0 * 1.6, "{}: {}", length, error);
                }
            }
        }
    }

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
    fn a_map_that_is_too_large_for_a_file_has_coarser_cells() {
        let mut map = OccupancyMap::new();
        map.add(CellIndex { col: 0, row: 0 }, -CLAMP);
        map.add(CellIndex { col: 9, row: 7 }, CLAMP);
        // Beside the wall, in the same cell of the file.
        map.add(CellIndex { col: 10, row: 7 }, -CLAMP);
        map.add(CellIndex { col: 50_000, row: 50_000 }, CLAMP);
        let found = map.to_ros_map().unwrap();
        assert_eq!((found.resolution, found.cols, found.rows()), (0.4, 6252, 6252));
        let at = |col: usize, row: usize| found.cells[row * found.cols + col];
        assert_eq!(
            [at(0, 0), at(1, 0), at(2, 0)],
            [RosCell::Free, RosCell::Occupied, RosCell::Unknown]
        );
        assert_eq!(at(6250, 6250), RosCell::Occupied);
        let known = found.cells.iter().filter(|cell| **cell != RosCell::Unknown).count();
        assert_eq!(known, 3);
    }
}
