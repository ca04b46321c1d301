//! Likelihood fields: how well an echo fits each position, given earlier echoes.

use glam::{DVec2, IVec2};

use crate::map::{RESOLUTION, floor};

/// Standard deviation in metres of the Gaussian around each echo.
pub const SIGMA: f64 = 0.07;

/// Number of cells that the Gaussian reaches from the cell of its echo: three standard deviations.
const REACH: i32 = 4;

/// Number of positions within a cell, along each axis, for which the Gaussian is tabulated.
const PLACES: i32 = 8;

/// Greatest number of cells along a side of a field: 205 m.
const MOST_CELLS: i32 = 4096;

/// Number of cells by which a field grows beyond what is needed.
const SPARE: i32 = 256;

/// A likelihood field: the likelihood of an echo, cell by cell, with max-pooled levels that bound it
/// from above over blocks of cells (Olson, Real-Time Correlative Scan Matching, ICRA 2009,
/// <https://doi.org/10.1109/ROBOT.2009.5152375>).
///
/// Each echo stamps a Gaussian of [`SIGMA`]; where several overlap, the greatest value counts. Each
/// cell of the level with blocks of b cells holds the greatest likelihood within the b x b cells from
/// it upwards and to the right. Levels are stamped, too, with pooled Gaussians, so that they are always
/// up to date.
///
/// Likelihoods are in 1/255. A field covers a rectangle of at most 205 m, which follows the positions
/// that it is asked to cover.
///
/// ```
/// use envgen::glam::DVec2;
/// use mapping_trial::slam::likelihood::{LikelihoodField, SIGMA};
///
/// let mut field = LikelihoodField::new(&[1]);
/// field.cover(DVec2::ZERO, 5.0);
/// field.stamp(DVec2::new(1.0, 1.0));
/// let at = |x| field.at(DVec2::new(x, 1.0));
/// assert!(at(1.0) > at(1.0 + SIGMA) && at(1.0 + SIGMA) > 0);
/// assert_eq!(at(2.0), 0);
/// ```
#[derive(Clone, Debug)]
pub struct LikelihoodField {
    /// The cell at the lower left.
    origin: IVec2,
    cols: i32,
    rows: i32,
    /// Whether the field was emptied because it would have grown beyond its limit, so that ground outside of it may
    /// have lost its stamps.
    is_moved: bool,
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    block: i32,
    stamps: Stamps,
    cells: Vec<u8>,
}

/// The Gaussians of a level, for each position of the echo within its cell. Their rows consist of
/// pieces of 16 bytes, which are combined at once.
#[derive(Clone, Debug)]
struct Stamps {
    /// Rows of one Gaussian.
    rows: i32,
    /// Pieces of 16 bytes per row.
    pieces: usize,
    table: Vec<[u8; 16]>,
}

impl Stamps {
    fn new(block: i32) -> Self {
        let side = 2 * REACH + block;
        let pieces = (side as usize).div_ceil(16);
        let mut table = Vec::new();
        for place_y in 0..PLACES {
            for place_x in 0..PLACES {
                for y in 0..side {
                    let mut row = vec![0; 16 * pieces];
                    for x in 0..side {
                        row[x as usize] = pooled(block, (x, place_x), (y, place_y));
                    }
                    table.extend(row.as_chunks::<16>().0);
                }
            }
        }
        Stamps { rows: side, pieces, table }
    }
}

/// The greatest likelihood over a block of cells, for an echo at a position within its cell. Offsets
/// count from the first cell that the pooled Gaussian reaches.
fn pooled(block: i32, x: (i32, i32), y: (i32, i32)) -> u8 {
    // The block's nearest cell on each axis decides, since the Gaussian falls along both.
    let nearest = |(offset, place): (i32, i32)| {
        let first = offset - REACH - (block - 1);
        (first..first + block)
            .filter(|cell| cell.abs() <= REACH)
            .map(|cell| {
                let echo = (f64::from(place) + 0.5) / f64::from(PLACES);
                (f64::from(cell) + 0.5 - echo).abs() * RESOLUTION
            })
            .fold(f64::INFINITY, f64::min)
    };
    let (dx, dy) = (nearest(x), nearest(y));
    (255.0 * libm::exp(-0.5 * (dx * dx + dy * dy) / (SIGMA * SIGMA))).round() as u8
}

impl LikelihoodField {
    /// Creates an empty field with pooled levels of the given blocks, of which the first must be 1.
    /// Blocks are clamped to 1..=64 cells.
    pub fn new(blocks: &[i32]) -> Self {
        let level = |&block: &i32| {
            let block = block.clamp(1, 64);
            Level { block, stamps: Stamps::new(block), cells: Vec::new() }
        };
        let levels = blocks.iter().map(level).collect();
        LikelihoodField { origin: IVec2::ZERO, cols: 0, rows: 0, is_moved: false, levels }
    }

    /// Returns the blocks of the levels, in order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = i32> + '_ {
        self.levels.iter().map(|level| level.block)
    }

    /// Returns the cell at the lower left corner of the covered rectangle. Cell (0, 0) has its lower
    /// left corner at the frame's origin.
    pub fn origin(&self) -> IVec2 {
        self.origin
    }

    /// Returns the number of cells in a row.
    pub fn cols(&self) -> usize {
        self.cols as usize
    }

    /// Returns the cells of a level, row by row from below, in 1/255.
    pub fn cells(&self, level: usize) -> &[u8] {
        &self.levels[level].cells
    }

    /// Returns the likelihood at a point in 1/255, which is 0 outside of the field.
    pub fn at(&self, p: DVec2) -> u8 {
        let cell = floor(p * (1.0 / RESOLUTION));
        let local = cell.saturating_sub(self.origin);
        let inside = local.min_element() >= 0 && local.x < self.cols && local.y < self.rows;
        let level = self.levels.first().filter(|_| inside);
        level.map_or(0, |level| level.cells[(local.y * self.cols + local.x) as usize])
    }

    /// Makes the field cover a square of half side `radius` metres around a point, with space for
    /// stamps and blocks.
    ///
    /// Earlier stamps are kept if possible. Returns false if the field may lack stamps: because it had to be emptied,
    /// as it would have grown beyond its limit, or because it has grown since then, perhaps over ground that it covered
    /// before. Squares of more than about 90 m half side are cut.
    pub fn cover(&mut self, centre: DVec2, radius: f64) -> bool {
        let largest = self.levels.iter().map(|level| level.block).max().unwrap_or(1);
        let margin = REACH + largest + 32;
        let half = ((radius / RESOLUTION).ceil().min(f64::from(MOST_CELLS / 2 - 256)) as i32)
            .saturating_add(margin);
        // Limits cells to numbers far from overflow, whatever the point.
        let middle =
            (centre / RESOLUTION).floor().clamp(DVec2::splat(-1e9), DVec2::splat(1e9)).as_ivec2();
        let (low, high) = (middle - half, middle + half + 1);
        let (had, top) = (self.origin, self.origin + IVec2::new(self.cols, self.rows));
        if low.cmpge(had).all() && high.cmple(top).all() {
            return true;
        }
        let spare = |low: IVec2, high: IVec2| (low - SPARE / 2, high + SPARE / 2);
        if self.cols == 0 {
            let (low, high) = spare(low, high);
            self.place(low, high);
            return true;
        }
        // Only the sides that are too short grow.
        let grown_low = IVec2::select(low.cmplt(had), low - SPARE, had);
        let grown_high = IVec2::select(high.cmpgt(top), high + SPARE, top);
        if (grown_high - grown_low).max_element() > MOST_CELLS {
            let (low, high) = spare(low, high);
            self.place(low, high);
            self.is_moved = true;
            return false;
        }
        self.grow(grown_low, grown_high);
        !self.is_moved
    }

    /// Forgets all echoes, and covers a square around a point instead.
    pub fn reset(&mut self, centre: DVec2, radius: f64) {
        (self.cols, self.rows, self.is_moved) = (0, 0, false);
        self.cover(centre, radius);
    }

    /// Forgets all echoes; the rectangle stays.
    pub fn clear(&mut self) {
        for level in &mut self.levels {
            level.cells.fill(0);
        }
    }

    /// Stamps the Gaussian of an echo at a point in metres, if the field covers its surroundings.
    pub fn stamp(&mut self, p: DVec2) {
        let scaled = p * (1.0 / RESOLUTION);
        let cell = floor(scaled);
        let place = ((scaled - cell.as_dvec2()) * f64::from(PLACES)).as_ivec2();
        let place = place.clamp(IVec2::ZERO, IVec2::splat(PLACES - 1));
        let cell = cell.saturating_sub(self.origin);
        let is_outside = cell.min_element() < 0 || cell.x >= self.cols || cell.y >= self.rows;
        if is_outside || p.is_nan() {
            return;
        }
        let table = (place.y * PLACES + place.x) as usize;
        for level in &mut self.levels {
            let stamps = &level.stamps;
            let wide = 16 * stamps.pieces as i32;
            let first = cell - REACH - (level.block - 1);
            if first.min_element() < 0
                || first.x + wide > self.cols
                || first.y + stamps.rows > self.rows
            {
                continue;
            }
            let rows = stamps.rows as usize;
            let stamp = &stamps.table[table * rows * stamps.pieces..][..rows * stamps.pieces];
            let mut start = (first.y * self.cols + first.x) as usize;
            for row in stamp.chunks_exact(stamps.pieces) {
                let (cells, _) = level.cells[start..start + wide as usize].as_chunks_mut::<16>();
                for (cells, values) in cells.iter_mut().zip(row) {
                    // Works on copies, which cannot overlap, so that one instruction does all 16. In
                    // builds with several codegen units `array::from_fn` and its closure are not
                    // inlined.
                    let (mut greater, values) = (*cells, *values);
                    for i in 0..16 {
                        greater[i] = greater[i].max(values[i]);
                    }
                    *cells = greater;
                }
                start += self.cols as usize;
            }
        }
    }

    /// Empties the field and moves it to a rectangle of cells.
    fn place(&mut self, low: IVec2, high: IVec2) {
        self.origin = low;
        (self.cols, self.rows) = (high.x - low.x, high.y - low.y);
        let count = self.cols as usize * self.rows as usize;
        for level in &mut self.levels {
            level.cells.clear();
            level.cells.resize(count, 0);
        }
    }

    /// Grows to a rectangle that contains the present one.
    fn grow(&mut self, low: IVec2, high: IVec2) {
        let (cols, rows) = ((high.x - low.x) as usize, (high.y - low.y) as usize);
        let shift = self.origin - low;
        for level in &mut self.levels {
            let mut cells = vec![0; cols * rows];
            let start = shift.y as usize * cols + shift.x as usize;
            let lines = cells[start..].chunks_mut(cols);
            for (to, from) in lines.zip(level.cells.chunks_exact(self.cols as usize)) {
                to[..from.len()].copy_from_slice(from);
            }
            level.cells = cells;
        }
        self.origin = low;
        (self.cols, self.rows) = (cols as i32, rows as i32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(field: &LikelihoodField, level: usize, cell: IVec2) -> u8 {
        let local = cell - field.origin();
        field.cells(level)[local.y as usize * field.cols() + local.x as usize]
    }

    #[test]
    fn a_stamp_is_a_gaussian_around_its_echo() {
        let mut field = LikelihoodField::new(&[1]);
        let echo = DVec2::new(1.234, -0.567);
        assert!(field.cover(echo, 1.0));
        field.stamp(echo);
        for y in -20..0 {
            for x in 15..35 {
                let centre = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * RESOLUTION;
                let distance = centre.distance(echo);
                let value = f64::from(at(&field, 0, IVec2::new(x, y))) / 255.0;
                let expected = libm::exp(-0.5 * distance * distance / (SIGMA * SIGMA));
                // The position within a cell is known to 1/8 of it; far tails are cut.
                assert!((value - expected).abs() < 0.05, "{value} for {expected} at {x}, {y}");
            }
        }
    }

    #[test]
    fn echoes_at_the_end_of_the_world_are_outside() {
        for far in [1e9, f64::MAX, f64::INFINITY, f64::NAN] {
            let mut field = LikelihoodField::new(&[1, 4]);
            field.cover(DVec2::ZERO, 5.0);
            for sign in [1.0, -1.0] {
                field.stamp(DVec2::new(sign * far, 0.0));
                field.stamp(DVec2::new(0.0, sign * far));
            }
            assert!(field.cells(0).iter().all(|&cell| cell == 0), "{far}");
            field.cover(DVec2::splat(far), 5.0);
            field.stamp(DVec2::splat(far));
        }
    }

    proptest! {
        #[test]
        fn pooled_levels_are_the_maxima_of_blocks(
            echoes in proptest::collection::vec((-2.0..2.0_f64, -2.0..2.0_f64), 1..20),
        ) {
            let mut field = LikelihoodField::new(&[1, 4, 16]);
            field.cover(DVec2::ZERO, 2.5);
            for &(x, y) in &echoes {
                field.stamp(DVec2::new(x, y));
            }
            for (level, block) in [(1, 4), (2, 16)] {
                for y in -56..44 {
                    for x in -56..44 {
                        let cells = (y..y + block).flat_map(|v| (x..x + block).map(move |u| (u, v)));
                        let greatest = cells.map(|(u, v)| at(&field, 0, IVec2::new(u, v))).max();
                        prop_assert_eq!(Some(at(&field, level, IVec2::new(x, y))), greatest);
                    }
                }
            }
        }

        #[test]
        fn growing_keeps_what_was_stamped(
            echoes in proptest::collection::vec((-30.0..30.0_f64, -30.0..30.0_f64), 1..20),
        ) {
            let (mut grown, mut whole) = (LikelihoodField::new(&[1, 4]), LikelihoodField::new(&[1, 4]));
            whole.cover(DVec2::ZERO, 32.0);
            for &(x, y) in &echoes {
                prop_assert!(grown.cover(DVec2::new(x, y), 1.0));
                grown.stamp(DVec2::new(x, y));
                whole.stamp(DVec2::new(x, y));
            }
            for &(x, y) in &echoes {
                let cell = (DVec2::new(x, y) / RESOLUTION).floor().as_ivec2();
                for level in 0..2 {
                    prop_assert_eq!(at(&grown, level, cell), at(&whole, level, cell));
                }
            }
        }
    }

    #[test]
    fn a_field_that_must_go_too_far_is_emptied() {
        let mut field = LikelihoodField::new(&[1]);
        assert!(field.cover(DVec2::ZERO, 10.0));
        field.stamp(DVec2::ZERO);
        assert!(!field.cover(DVec2::new(5000.0, 0.0), 10.0));
        assert!(field.cells(0).iter().all(|&cell| cell == 0));
        assert!(field.cells(0).len() < 1 << 22);
        // Back on old ground, whose stamps are lost, it says so as well.
        assert!(field.cover(DVec2::new(5001.0, 0.0), 10.0));
        assert!(!field.cover(DVec2::new(4950.0, 0.0), 10.0));
        field.reset(DVec2::ZERO, 10.0);
        assert!(field.cover(DVec2::new(50.0, 0.0), 10.0));
        // Stamps outside of the field are left out.
        field.stamp(DVec2::new(5000.0, 0.0));
        field.stamp(DVec2::splat(f64::NAN));
    }
}
