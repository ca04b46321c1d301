//! The occupancy map that robots make: log odds on a grid that grows.

mod error;

use envgen::geometry::{Pose, Rect};
use glam::{DVec2, IVec2};

pub use error::MapError;

/// Side of a cell in metres.
pub const RESOLUTION: f64 = 0.05;

/// Middles of cells that lie on borders of cells of another map, as in a map that is half a cell off, take the
/// cells on the same side, as a fraction of a cell: rounding would take some cells twice and others never.
pub(crate) const TIE: f64 = 1e-6;

/// Cells along a side of a tile.
pub const TILE: i32 = 32;

/// Log odds in hundredths that an echo adds to its cell.
pub const HIT: i16 = 85;

/// Log odds in hundredths that a ray subtracts from each cell that it passes through.
pub const MISS: i16 = 40;

/// Greatest absolute log odds of a cell, in hundredths.
pub const CLAMP: i16 = 400;

/// Log odds in hundredths above which a cell is occupied (probability 0.65). Below their negative it is
/// free (0.35).
pub const DECIDED: i16 = 62;

/// Greatest number of tiles along a side of the map: 6.5 km.
pub(crate) const MAX_TILES: i64 = 4096;

/// The state of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Nothing is known.
    Unknown,
    /// No obstacle.
    Free,
    /// An obstacle or a wall.
    Occupied,
}

/// The column and row of a cell. Cell (0, 0) has its lower left corner at the frame's origin.
///
/// ```
/// use envgen::glam::DVec2;
/// use mapping_trial::map::CellIndex;
///
/// // Cells of 5 cm, also on the other side of the origin.
/// assert_eq!(CellIndex::of(DVec2::new(0.12, -0.01)), CellIndex { col: 2, row: -1 });
/// let centre = CellIndex { col: 2, row: -1 }.centre();
/// assert!(centre.distance(DVec2::new(0.125, -0.025)) < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellIndex {
    /// Column, which increases to the right.
    pub col: i32,
    /// Row, which increases upwards.
    pub row: i32,
}

impl CellIndex {
    /// Returns the cell that contains a point, given in metres in the map's frame.
    #[inline]
    pub fn of(p: DVec2) -> CellIndex {
        let cell = floor(p * (1.0 / RESOLUTION));
        CellIndex { col: cell.x, row: cell.y }
    }

    /// Returns the centre of the cell in metres.
    pub fn centre(self) -> DVec2 {
        (DVec2::new(f64::from(self.col), f64::from(self.row)) + 0.5) * RESOLUTION
    }

    /// The tile that contains the cell.
    fn tile(self) -> (i32, i32) {
        (self.col.div_euclid(TILE), self.row.div_euclid(TILE))
    }
}

/// An occupancy grid of log odds in the world's frame, stored in tiles.
///
/// Every tile has the revision of its last change, so that what is derived from a map (frontiers,
/// costs, pictures) can be updated only where the map changed.
///
/// ```
/// use envgen::glam::DVec2;
/// use mapping_trial::map::{Cell, CellIndex, HIT, MISS, OccupancyMap};
///
/// let mut map = OccupancyMap::new();
/// let (here, wall) = (CellIndex::of(DVec2::ZERO), CellIndex::of(DVec2::new(0.5, 0.0)));
/// for _scan in 0..2 {
///     map.add(here, -MISS);
///     map.add(wall, HIT);
/// }
/// assert_eq!((map.cell(here), map.cell(wall)), (Cell::Free, Cell::Occupied));
/// assert_eq!(map.cell(CellIndex::of(DVec2::new(3.0, 0.0))), Cell::Unknown);
/// ```
#[derive(Clone, Debug, Default)]
pub struct OccupancyMap {
    /// Column and row of the lower left tile of the table.
    corner: (i32, i32),
    cols: i32,
    rows: i32,
    /// Index into `tiles` of each tile of the table, row by row from below.
    table: Vec<u32>,
    tiles: Vec<Tile>,
    revision: u64,
}

/// A square of [`TILE`] x [`TILE`] cells.
#[derive(Clone, Debug)]
struct Tile {
    at: (i32, i32),
    revision: u64,
    cells: Box<[i16]>,
}

/// The index of a tile that does not exist.
const NONE: u32 = u32::MAX;

impl OccupancyMap {
    /// Creates a map in which every cell is unknown.
    pub fn new() -> Self {
        OccupancyMap::default()
    }

    /// Replaces all cells by those of another map, such as one that another program has drawn. The revision
    /// rises, and all that is derived from the map is updated.
    ///
    /// ```
    /// use mapping_trial::map::{CellIndex, MISS, OccupancyMap};
    ///
    /// let (mut map, mut other) = (OccupancyMap::new(), OccupancyMap::new());
    /// other.add(CellIndex { col: 0, row: 0 }, -MISS);
    /// for _time in 0..2 {
    ///     let before = map.revision();
    ///     map.replace(other.clone());
    ///     assert_eq!(map.changed_since(before).collect::<Vec<_>>(), [(0, 0)]);
    /// }
    /// ```
    pub fn replace(&mut self, other: OccupancyMap) {
        let revision = self.revision + 1;
        *self = OccupancyMap { revision, ..other };
        for tile in &mut self.tiles {
            tile.revision = revision;
        }
    }

    /// Returns the revision of the map, which rises with every change that [`OccupancyMap::touch`]
    /// announces.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Returns the state of a cell.
    pub fn cell(&self, index: CellIndex) -> Cell {
        let odds = self.log_odds(index);
        if odds > DECIDED {
            Cell::Occupied
        } else if odds < -DECIDED {
            Cell::Free
        } else {
            Cell::Unknown
        }
    }

    /// Returns the log odds of a cell in hundredths, which are 0 where nothing is known.
    pub fn log_odds(&self, index: CellIndex) -> i16 {
        let (col, row) = index.tile();
        self.slot(col, row).map_or(0, |slot| self.tiles[slot].cells[place(index)])
    }

    /// Adds log odds in hundredths to a cell, within [`CLAMP`]. Cells farther out than the map can grow
    /// stay unknown.
    ///
    /// ```
    /// use mapping_trial::map::{CLAMP, CellIndex, HIT, OccupancyMap};
    ///
    /// let (mut map, cell) = (OccupancyMap::new(), CellIndex { col: 3, row: 4 });
    /// map.add(cell, HIT);
    /// assert_eq!(map.log_odds(cell), HIT);
    /// // What is seen often does not become more certain than this.
    /// (0..10).for_each(|_| map.add(cell, HIT));
    /// assert_eq!(map.log_odds(cell), CLAMP);
    /// ```
    pub fn add(&mut self, index: CellIndex, change: i16) {
        let (col, row) = index.tile();
        let Some(slot) = self.slot(col, row).or_else(|| self.grow(col, row)) else { return };
        let cell = &mut self.tiles[slot].cells[place(index)];
        *cell = cell.saturating_add(change).clamp(-CLAMP, CLAMP);
    }

    /// Announces that cells in a rectangle (in metres) have changed: the revisions of the map and of
    /// the tiles there rise.
    ///
    /// ```
    /// use mapping_trial::map::{CellIndex, MISS, OccupancyMap};
    ///
    /// let (mut map, cell) = (OccupancyMap::new(), CellIndex { col: 0, row: 0 });
    /// map.add(cell, -MISS);
    /// let before = map.revision();
    /// map.touch(envgen::geometry::Rect::new(cell.centre(), cell.centre()));
    /// // What is derived from the map is now updated around the cell.
    /// assert!(map.revision() > before);
    /// assert_eq!(map.changed_since(before).collect::<Vec<_>>(), [(0, 0)]);
    /// ```
    pub fn touch(&mut self, area: Rect) {
        self.revision += 1;
        let (low, high) = (CellIndex::of(area.min).tile(), CellIndex::of(area.max).tile());
        let top = (self.corner.0 + self.cols - 1, self.corner.1 + self.rows - 1);
        for row in low.1.max(self.corner.1)..=high.1.min(top.1) {
            for col in low.0.max(self.corner.0)..=high.0.min(top.0) {
                if let Some(slot) = self.slot(col, row) {
                    self.tiles[slot].revision = self.revision;
                }
            }
        }
    }

    /// Makes every cell unknown, and announces the change. The tiles stay, so that what is derived from
    /// the map is also updated for cells that are not drawn again.
    pub fn clear(&mut self) {
        self.revision += 1;
        for tile in &mut self.tiles {
            tile.cells.fill(0);
            tile.revision = self.revision;
        }
    }

    /// Begins a change: the tiles that [`OccupancyMap::tile_mut`] returns from now on get a new
    /// revision.
    pub(crate) fn begin(&mut self) {
        self.revision += 1;
    }

    /// Returns the cells of a tile, to be changed as part of the change that was begun; `None` where
    /// the map may not grow.
    pub(crate) fn tile_mut(&mut self, col: i32, row: i32) -> Option<&mut [i16]> {
        let slot = self.slot(col, row).or_else(|| self.grow(col, row))?;
        let tile = &mut self.tiles[slot];
        tile.revision = self.revision;
        Some(&mut tile.cells)
    }

    /// Returns the rectangle in metres around all tiles that were ever written; `None` before the
    /// first.
    pub fn bounds(&self) -> Option<Rect> {
        let side = f64::from(TILE) * RESOLUTION;
        Rect::around(self.tiles.iter().flat_map(|tile| {
            let low = DVec2::new(f64::from(tile.at.0), f64::from(tile.at.1));
            [low * side, (low + 1.0) * side]
        }))
    }

    /// Returns the columns and rows of the tiles that have changed since a revision, in an arbitrary
    /// but repeatable order. Tile column c has the cell columns c * [`TILE`] to c * [`TILE`] + TILE -
    /// 1.
    pub fn changed_since(&self, revision: u64) -> impl Iterator<Item = (i32, i32)> + '_ {
        self.tiles.iter().filter(move |tile| tile.revision > revision).map(|tile| tile.at)
    }

    /// Returns every tile that was ever written, in an arbitrary but repeatable order: its column, its
    /// row and the log odds of its cells as in [`OccupancyMap::tile`].
    pub fn tiles(&self) -> impl Iterator<Item = ((i32, i32), &[i16])> + '_ {
        self.tiles.iter().map(|tile| (tile.at, &*tile.cells))
    }

    /// Returns the log odds of a tile's cells in hundredths, row by row from below; `None` for a tile
    /// that was never written.
    pub fn tile(&self, col: i32, row: i32) -> Option<&[i16]> {
        self.slot(col, row).map(|slot| &*self.tiles[slot].cells)
    }

    fn slot(&self, col: i32, row: i32) -> Option<usize> {
        let (x, y) = (col.wrapping_sub(self.corner.0), row.wrapping_sub(self.corner.1));
        if x < 0 || y < 0 || x >= self.cols || y >= self.rows {
            return None;
        }
        let slot = self.table[(y * self.cols + x) as usize];
        (slot != NONE).then_some(slot as usize)
    }

    /// Creates a tile and extends the table if needed; `None` where the map may not grow.
    fn grow(&mut self, col: i32, row: i32) -> Option<usize> {
        let empty = self.table.is_empty();
        let low = if empty { (col, row) } else { (self.corner.0.min(col), self.corner.1.min(row)) };
        let high = if empty {
            (col, row)
        } else {
            ((self.corner.0 + self.cols - 1).max(col), (self.corner.1 + self.rows - 1).max(row))
        };
        let (cols, rows) =
            (i64::from(high.0) - i64::from(low.0) + 1, i64::from(high.1) - i64::from(low.1) + 1);
        if cols > MAX_TILES || rows > MAX_TILES {
            return None;
        }
        if (low, cols as i32, rows as i32) != (self.corner, self.cols, self.rows) {
            let mut table = vec![NONE; (cols * rows) as usize];
            for (slot, tile) in self.tiles.iter().enumerate() {
                let (x, y) = (tile.at.0 - low.0, tile.at.1 - low.1);
                table[(i64::from(y) * cols + i64::from(x)) as usize] = slot as u32;
            }
            (self.corner, self.cols, self.rows) = (low, cols as i32, rows as i32);
            self.table = table;
        }
        let slot = self.tiles.len();
        let cells = vec![0; (TILE * TILE) as usize].into_boxed_slice();
        self.tiles.push(Tile { at: (col, row), revision: self.revision, cells });
        let (x, y) = (col - self.corner.0, row - self.corner.1);
        self.table[(y * self.cols + x) as usize] = slot as u32;
        Some(slot)
    }
}

/// The greatest integers that are not above two numbers; saturating, and 0 for NaN. On processors
/// without an instruction for it, `f64::floor` would be a function call.
#[inline]
pub(crate) fn floor(p: DVec2) -> IVec2 {
    let floor = |v: f64| {
        let towards_zero = v as i32;
        towards_zero.saturating_sub(i32::from(f64::from(towards_zero) > v))
    };
    IVec2::new(floor(p.x), floor(p.y))
}

/// Index of a cell in its tile.
fn place(index: CellIndex) -> usize {
    (index.row.rem_euclid(TILE) * TILE + index.col.rem_euclid(TILE)) as usize
}

/// An estimated pose of a robot, with its uncertainty.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The estimated pose.
    pub pose: Pose,
    /// Standard deviation of the position in metres, as the estimator sees it. Those of the built-in estimators leave
    /// out that an error of the heading stays along the path: over long paths that no wall corrects, the true one
    /// is several times as large.
    pub deviation: f64,
    /// Standard deviation of the heading in radians, as the estimator sees it.
    pub heading_deviation: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(col: i32, row: i32) -> CellIndex {
        CellIndex { col, row }
    }

    #[test]
    fn a_hit_occupies_and_two_misses_free() {
        let mut map = OccupancyMap::new();
        assert_eq!(map.cell(at(3, -4)), Cell::Unknown);
        map.add(at(3, -4), HIT);
        assert_eq!(map.cell(at(3, -4)), Cell::Occupied);
        map.add(at(-1, 0), -MISS);
        assert_eq!(map.cell(at(-1, 0)), Cell::Unknown);
        map.add(at(-1, 0), -MISS);
        assert_eq!(map.cell(at(-1, 0)), Cell::Free);
        (0..50).for_each(|_| map.add(at(-1, 0), HIT));
        assert_eq!(map.log_odds(at(-1, 0)), CLAMP);
        map.add(at(-1, 0), i16::MAX);
        assert_eq!(map.log_odds(at(-1, 0)), CLAMP);
        map.add(at(-1, 0), i16::MIN);
        assert_eq!(map.log_odds(at(-1, 0)), -CLAMP);
        assert_eq!(map.cell(at(0, 0)), Cell::Unknown);
    }

    #[test]
    fn tiles_report_changes_and_being_forgotten() {
        let mut map = OccupancyMap::new();
        map.add(at(0, 0), HIT);
        map.add(at(100, 100), HIT);
        let side = f64::from(TILE) * RESOLUTION;
        map.touch(Rect::new(DVec2::ZERO, DVec2::splat(0.5 * side)));
        let first = map.revision();
        assert_eq!(map.changed_since(first - 1).collect::<Vec<_>>(), [(0, 0)]);
        map.touch(Rect::new(DVec2::splat(3.2 * side), DVec2::splat(99.0 * side)));
        assert_eq!(map.changed_since(first).collect::<Vec<_>>(), [(3, 3)]);
        let second = map.revision();
        map.clear();
        assert_eq!(map.changed_since(second).count(), 2);
        assert_eq!(map.cell(at(0, 0)), Cell::Unknown);
        assert!(map.tile(3, 3).is_some_and(|cells| cells.iter().all(|&odds| odds == 0)));
        assert_eq!(map.bounds(), Some(Rect::new(DVec2::ZERO, DVec2::splat(4.0 * side))));
    }

    #[test]
    fn a_map_grows_so_far() {
        let mut map = OccupancyMap::new();
        map.add(at(0, 0), HIT);
        let farthest = (MAX_TILES as i32) * TILE;
        for out in [farthest, i32::MAX, i32::MIN] {
            map.add(at(out, 0), HIT);
            map.add(at(0, out), HIT);
            assert_eq!(map.cell(at(out, 0)), Cell::Unknown);
        }
        map.add(at(farthest - 1, 0), HIT);
        assert_eq!(map.cell(at(farthest - 1, 0)), Cell::Occupied);
        assert_eq!(map.cell(at(0, 0)), Cell::Occupied);
    }

    proptest! {
        #[test]
        fn cells_hold_what_was_added(
            changes in proptest::collection::vec((-300..300_i32, -300..300_i32, -90..90_i16), 0..60),
        ) {
            let (mut map, mut plain) = (OccupancyMap::new(), std::collections::BTreeMap::new());
            for &(col, row, change) in &changes {
                map.add(at(col, row), change);
                let odds: &mut i16 = plain.entry((col, row)).or_default();
                *odds = (*odds + change).clamp(-CLAMP, CLAMP);
            }
            for (&(col, row), &odds) in &plain {
                prop_assert_eq!(map.log_odds(at(col, row)), odds);
                let bounds = map.bounds().expect("something was written");
                prop_assert!(bounds.contains(at(col, row).centre()));
                let tile = map.tile(col.div_euclid(TILE), row.div_euclid(TILE)).expect("written");
                prop_assert_eq!(tile[place(at(col, row))], odds);
            }
        }

        #[test]
        fn rounding_down_is_that_of_floats(x in any::<f64>(), y in -1e10..1e10_f64, z in -9..9_i32) {
            for v in [x, y, f64::from(z), f64::from(z) - 1e-9, 0.1 * f64::from(z)] {
                prop_assert_eq!(floor(DVec2::new(v, -v)), DVec2::new(v, -v).floor().as_ivec2());
            }
        }

        #[test]
        fn any_point_has_a_cell(x in any::<f64>(), y in any::<f64>()) {
            let index = CellIndex::of(DVec2::new(x, y));
            prop_assert_eq!(OccupancyMap::new().cell(index), Cell::Unknown);
        }
    }
}
