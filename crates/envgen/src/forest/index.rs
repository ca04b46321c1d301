//! Grids that find the points near a position.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec2;

use crate::geometry::Rect;

/// The operations that sequential addition needs from an index of the placed points.
pub(super) trait PointIndex {
    /// Whether a placed point is nearer than the least distance.
    fn conflicts(&self, p: DVec2) -> bool;

    /// Reads the memory that [`PointIndex::conflicts`] will read, and nothing else. Many such reads run at the same
    /// time, whereas whole look-ups would wait for each other.
    fn touch(&self, p: DVec2) -> u32;

    /// Adds a point that does not conflict.
    fn insert(&mut self, p: DVec2);

    /// Returns the points in the order in which they were added.
    fn into_points(self) -> Vec<DVec2>;
}

/// A grid with cells so small that each contains at most one point.
///
/// With a cell side of distance / sqrt 2, a conflicting point is at most two cells away. A cell takes two bytes,
/// which give its point to within 1/255 of the side. This is enough to decide all but one position in a hundred,
/// and so little that the grid of a million points fits into a processor's cache. Positions that it cannot decide
/// are looked up in a [`CellList`].
pub(super) struct FineGrid {
    per_cell: f64,
    /// Number of columns, including margins. Because of the margins, look-ups need not check for borders; on a
    /// torus they contain copies of the points from the opposite side.
    stride: usize,
    /// 0 for a cell without a point; otherwise the point's position in the cell in steps of 1/255 of the side: the
    /// position along x plus one in the high byte, the position along y in the low byte.
    codes: Vec<u16>,
    /// The points themselves, with the area and whether it is a torus.
    exact: CellList,
}

/// Number of cells around the area, on every side.
const MARGIN: usize = 2;

/// Number of cells of a row that a look-up reads: the five that matter, and three that fill a register and are too
/// far away to conflict.
const RUN: usize = 8;

/// Number of steps of a code along a cell's side.
const STEPS: f64 = 255.0;

/// The least distance in steps, and the greatest error of a distance between a position and a coded point: half a
/// step along both axes, and rounding.
const DISTANCE_IN_STEPS: f64 = STEPS * std::f64::consts::SQRT_2;
const CODE_ERROR: f64 = 0.75;

impl FineGrid {
    /// Whether the grid takes at most 16 cells per point, 32 bytes.
    pub(super) fn suits(area: Rect, distance: f64, count: u64) -> bool {
        let size = (area.size() / (distance * FRAC_1_SQRT_2)).ceil();
        size.x * size.y <= 16.0 * count as f64 + 4096.0
    }

    pub(super) fn new(area: Rect, distance: f64, count: u64, torus: bool) -> Self {
        let per_cell = 1.0 / (distance * FRAC_1_SQRT_2);
        let size = (area.size() * per_cell).floor();
        let (cols, rows) = (size.x as usize + 1, size.y as usize + 1);
        let stride = cols + MARGIN + RUN;
        let cells = stride * (rows + 2 * MARGIN);
        let exact = CellList::new(area, distance, count, torus);
        FineGrid { per_cell, stride, codes: vec![0; cells], exact }
    }

    /// Converts a position into cells from the lower left corner of the grid, margins included.
    fn scaled(&self, p: DVec2) -> DVec2 {
        (p - self.exact.area.min) * self.per_cell + MARGIN as f64
    }

    /// Returns the cell at the lower left of the five by five cells around a position.
    fn first_around(&self, at: DVec2) -> usize {
        (at.y as usize - MARGIN) * self.stride + at.x as usize - MARGIN
    }

    /// Writes the code of a point into the cell that contains a copy of it.
    fn set(&mut self, at: DVec2) {
        let cell = at.floor();
        let steps = ((at - cell) * STEPS).floor().min(DVec2::splat(STEPS - 1.0));
        let index = cell.y as usize * self.stride + cell.x as usize;
        self.codes[index] = ((steps.x as u16 + 1) << 8) | steps.y as u16;
    }
}

/// Returns an offset, on a torus in the shorter direction.
fn shorter_offset(offset: DVec2, area: Rect, torus: bool) -> DVec2 {
    if !torus {
        return offset;
    }
    let size = area.size();
    offset - size * (offset / size).round()
}

impl PointIndex for FineGrid {
    #[inline]
    fn conflicts(&self, p: DVec2) -> bool {
        let at = self.scaled(p);
        let cell = at.floor();
        let first = self.first_around(at);
        // No two points share a cell.
        if self.codes[first + MARGIN * self.stride + MARGIN] != 0 {
            return true;
        }
        // Steps from the lower left corner of the five by five cells around to the place, less half
        // a step, which puts the coded points into the middle of their steps.
        let from = (at - cell + MARGIN as f64) * STEPS - 0.5;
        let (x, y) = (from.x as f32, from.y as f32);
        let mut nearest = [f32::INFINITY; RUN];
        for row in 0..=2 * MARGIN {
            let run = &self.codes[first + row * self.stride..][..RUN];
            let bottom = row as f32 * STEPS as f32 - y;
            for (col, (&code, nearest)) in run.iter().zip(&mut nearest).enumerate() {
                let dx = f32::from(code >> 8) + (col as f32 * STEPS as f32 - 1.0 - x);
                let dy = f32::from(code & 0xff) + bottom;
                let squared = dx * dx + dy * dy;
                *nearest = nearest.min(if code == 0 { f32::INFINITY } else { squared });
            }
        }
        let nearest = nearest.into_iter().fold(f32::INFINITY, f32::min);
        const SURELY: f64 = DISTANCE_IN_STEPS - CODE_ERROR;
        const HARDLY: f64 = DISTANCE_IN_STEPS + CODE_ERROR;
        nearest < (SURELY * SURELY) as f32
            || (nearest < (HARDLY * HARDLY) as f32 && self.exact.conflicts(p))
    }

    fn insert(&mut self, p: DVec2) {
        self.exact.insert(p);
        self.set(self.scaled(p));
        if !self.exact.torus {
            return;
        }
        let size = self.exact.area.size();
        let margin = MARGIN as f64;
        // The cells that positions of the area lie in, and the margins around them.
        let high = (size * self.per_cell).floor() + 1.0 + 2.0 * margin;
        for (i, j) in [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)] {
            let at = self.scaled(p + size * DVec2::new(f64::from(i), f64::from(j)));
            if at.cmpge(DVec2::ZERO).all() && at.cmplt(high).all() {
                self.set(at);
            }
        }
    }

    fn touch(&self, p: DVec2) -> u32 {
        let first = self.first_around(self.scaled(p));
        let rows = (0..=2 * MARGIN).map(|row| u32::from(self.codes[first + row * self.stride]));
        rows.fold(self.exact.touch(p), |sum, code| sum ^ code)
    }

    fn into_points(self) -> Vec<DVec2> {
        self.exact.into_points()
    }
}

/// A grid of cells that are at least as wide as the reach of a query, each with a list of its points.
pub(super) struct CellList {
    area: Rect,
    torus: bool,
    reach: f64,
    side: DVec2,
    cols: usize,
    rows: usize,
    /// The first point of each cell's list; [`NONE`] if it is empty.
    head: Vec<u32>,
    next: Vec<u32>,
    points: Vec<DVec2>,
}

const NONE: u32 = u32::MAX;

impl CellList {
    /// Creates an empty grid for about `count` points in `area`, for queries within `reach`.
    pub(super) fn new(area: Rect, reach: f64, count: u64, torus: bool) -> Self {
        let size = area.size();
        let spacing = (size.x * size.y / (count as f64 + 1.0)).sqrt();
        let cells = (size / reach.max(spacing)).floor().max(DVec2::ONE);
        let (cols, rows) = (cells.x as usize, cells.y as usize);
        CellList {
            area,
            torus,
            reach,
            side: size / cells,
            cols,
            rows,
            head: vec![NONE; cols * rows],
            next: Vec::with_capacity(count as usize),
            points: Vec::with_capacity(count as usize),
        }
    }

    /// Creates a grid that contains all points.
    pub(super) fn of(
        area: Rect,
        reach: f64,
        torus: bool,
        points: impl ExactSizeIterator<Item = DVec2>,
    ) -> Self {
        let mut list = CellList::new(area, reach, points.len() as u64, torus);
        points.for_each(|p| list.insert(p));
        list
    }

    /// Calls `visit` for every point that may be within the reach, with its number in the order of insertion and
    /// its offset from `p`, on a torus in the shorter direction.
    pub(super) fn visit(&self, p: DVec2, mut visit: impl FnMut(u32, DVec2)) {
        self.any(p, |i, offset| {
            visit(i, offset);
            false
        });
    }

    /// Returns the distance in metres from `p` to the nearest point other than number `except`; infinite if there
    /// are no others. It searches ring by ring around the cell of `p`.
    pub(super) fn nearest(&self, p: DVec2, except: u32) -> f64 {
        let (col, row) = self.cell(p);
        // On each axis, the first and last cell of the grid as seen from here.
        let axis = |at: usize, len: usize| {
            let (at, len) = (at as i64, len as i64);
            if self.torus { (-(len / 2), (len - 1) / 2) } else { (-at, len - 1 - at) }
        };
        let (xs, ys) = (axis(col, self.cols), axis(row, self.rows));
        let last_ring = [xs.0, xs.1, ys.0, ys.1].map(i64::abs).into_iter().max().unwrap_or(0);
        // A cell of ring k is at least k - 1 cells away along an axis that has that many.
        let wide = |len: usize, side: f64| if len > 1 { side } else { f64::INFINITY };
        let side = wide(self.cols, self.side.x).min(wide(self.rows, self.side.y));
        let mut best = f64::INFINITY;
        for ring in 0..=last_ring {
            if ring > 1 && (ring - 1) as f64 * side > best {
                break;
            }
            for dy in (-ring).max(ys.0)..=ring.min(ys.1) {
                let whole_row = dy.abs() == ring;
                let step = if whole_row { 1 } else { (2 * ring).max(1) };
                let first = if whole_row { (-ring).max(xs.0) } else { -ring };
                for dx in (first..=ring.min(xs.1)).step_by(step as usize) {
                    if dx < xs.0 {
                        continue;
                    }
                    let x = (col as i64 + dx).rem_euclid(self.cols as i64);
                    let y = (row as i64 + dy).rem_euclid(self.rows as i64);
                    let mut i = self.head[y as usize * self.cols + x as usize];
                    while i != NONE {
                        if i != except {
                            best = best.min(self.offset(p, self.points[i as usize]).length());
                        }
                        i = self.next[i as usize];
                    }
                }
            }
        }
        best
    }

    /// Whether `found` is true for any point that may be within the reach, visited as by [`CellList::visit`].
    /// `found` is not called again after the first such point.
    pub(super) fn any(&self, p: DVec2, mut found: impl FnMut(u32, DVec2) -> bool) -> bool {
        let (col, row) = self.cell(p);
        let near = |at: usize, len: usize| -> [Option<usize>; 3] {
            let (below, above) = (at.checked_sub(1), (at + 1 < len).then_some(at + 1));
            match (self.torus, len) {
                (false, _) => [below, Some(at), above],
                (true, 1) => [None, Some(0), None],
                (true, 2) => [None, Some(0), Some(1)],
                (true, _) => [Some(below.unwrap_or(len - 1)), Some(at), Some(above.unwrap_or(0))],
            }
        };
        for row in near(row, self.rows).into_iter().flatten() {
            for col in near(col, self.cols).into_iter().flatten() {
                let mut i = self.head[row * self.cols + col];
                while i != NONE {
                    if found(i, self.offset(p, self.points[i as usize])) {
                        return true;
                    }
                    i = self.next[i as usize];
                }
            }
        }
        false
    }

    fn offset(&self, from: DVec2, to: DVec2) -> DVec2 {
        shorter_offset(to - from, self.area, self.torus)
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let cell = (p - self.area.min) / self.side;
        ((cell.x as usize).min(self.cols - 1), (cell.y as usize).min(self.rows - 1))
    }
}

impl PointIndex for CellList {
    fn conflicts(&self, p: DVec2) -> bool {
        let reach2 = self.reach * self.reach;
        self.any(p, |_, offset| offset.length_squared() < reach2)
    }

    fn insert(&mut self, p: DVec2) {
        let (col, row) = self.cell(p);
        let head = &mut self.head[row * self.cols + col];
        self.next.push(*head);
        *head = self.points.len() as u32;
        self.points.push(p);
    }

    fn touch(&self, p: DVec2) -> u32 {
        let (col, row) = self.cell(p);
        self.head[row * self.cols + col]
    }

    fn into_points(self) -> Vec<DVec2> {
        self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_nearest_point_is_the_nearest(
            points in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..60),
            width in 0.01..50.0_f64,
            height in 0.01..50.0_f64,
            torus: bool,
        ) {
            let area = Rect::new(DVec2::ZERO, DVec2::new(width, height));
            let points: Vec<_> = points.iter().map(|&p| DVec2::from(p) * area.size()).collect();
            let spacing = (width * height / points.len() as f64).sqrt();
            let list = CellList::of(area, spacing, torus, points.iter().copied());
            for (i, &p) in points.iter().enumerate() {
                let others = points.iter().enumerate().filter(|(j, _)| *j != i);
                let brute = others
                    .map(|(_, &q)| shorter_offset(q - p, area, torus).length())
                    .fold(f64::INFINITY, f64::min);
                prop_assert_eq!(list.nearest(p, i as u32), brute);
            }
        }

        #[test]
        fn both_grids_agree_with_brute_force(
            points in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..80),
            width in 2.0..20.0_f64,
            height in 2.0..20.0_f64,
            distance in 0.05..1.0_f64,
            torus: bool,
        ) {
            let area = Rect::new(DVec2::new(-1.0, 3.0), DVec2::new(width - 1.0, height + 3.0));
            let mut fine = FineGrid::new(area, distance, 80, torus);
            let mut coarse = CellList::new(area, distance, points.len() as u64, torus);
            let mut placed: Vec<DVec2> = Vec::new();
            for (x, y) in points {
                let p = area.min + DVec2::new(x, y) * area.size();
                let conflict = placed.iter().any(|&q| {
                    let mut d = (q - p).abs();
                    if torus {
                        d = d.min(area.size() - d);
                    }
                    d.length_squared() < distance * distance
                });
                prop_assert_eq!(coarse.conflicts(p), conflict);
                prop_assert_eq!(fine.conflicts(p), conflict);
                if !conflict {
                    placed.push(p);
                    coarse.insert(p);
                    fine.insert(p);
                }
            }
        }
    }
}
