//! Grids that answer "which points stand near here".

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec2;

use super::hard_core::Standing;
use crate::geometry::Rect;

/// A grid whose cells are so small that each holds at most one point, stored in the cell itself.
///
/// With a cell side of distance / sqrt 2 a conflicting point stands at most two cells away. Looking
/// at a place reads five short runs of memory and follows no index.
pub(super) struct FineGrid {
    area: Rect,
    torus: bool,
    distance2: f64,
    per_cell: f64,
    /// Columns, two more on each side included: no look-up checks a border, and on a torus the
    /// border cells hold copies of the points from the other side.
    stride: usize,
    /// NaN where no point stands: comparisons with it are false.
    cells: Vec<[f64; 2]>,
}

const MARGIN: usize = 2;

impl FineGrid {
    /// Whether the grid takes at most 16 cells a point, 256 bytes.
    pub(super) fn suits(area: Rect, distance: f64, count: u64) -> bool {
        let size = (area.size() / (distance * FRAC_1_SQRT_2)).ceil();
        size.x * size.y <= 16.0 * count as f64 + 4096.0
    }

    pub(super) fn new(area: Rect, distance: f64, torus: bool) -> Self {
        let per_cell = 1.0 / (distance * FRAC_1_SQRT_2);
        let size = (area.size() * per_cell).floor();
        let (cols, rows) = (size.x as usize + 1, size.y as usize + 1);
        let stride = cols + 2 * MARGIN;
        let cells = vec![[f64::NAN; 2]; stride * (rows + 2 * MARGIN)];
        FineGrid { area, torus, distance2: distance * distance, per_cell, stride, cells }
    }

    fn cell(&self, p: DVec2) -> usize {
        let cell = (p - self.area.min) * self.per_cell;
        (cell.y as usize + MARGIN) * self.stride + cell.x as usize + MARGIN
    }
}

impl Standing for FineGrid {
    #[inline]
    fn conflicts(&self, p: DVec2) -> bool {
        let cell = self.cell(p);
        let near = |q: &[f64; 2]| {
            let (dx, dy) = (q[0] - p.x, q[1] - p.y);
            dx * dx + dy * dy < self.distance2
        };
        // The corners of the five by five cells are too far away to matter, but skipping them costs
        // more than looking.
        (0..=2 * MARGIN).any(|row| {
            let first = cell + row * self.stride - MARGIN * self.stride - MARGIN;
            let run = &self.cells[first..=first + 2 * MARGIN];
            // Without a short cut inside the run: five comparisons cost less than a wrong guess.
            run.iter().fold(false, |any, q| any | near(q))
        })
    }

    fn insert(&mut self, p: DVec2) {
        let cell = self.cell(p);
        self.cells[cell] = p.into();
        if !self.torus {
            return;
        }
        let size = self.area.size();
        let margin = MARGIN as f64;
        let reach = (size * self.per_cell).floor() + margin + 1.0;
        for (i, j) in [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)] {
            let copy = p + size * DVec2::new(f64::from(i), f64::from(j));
            let at = ((copy - self.area.min) * self.per_cell + margin).floor();
            if at.cmpge(DVec2::ZERO).all() && at.cmplt(reach + margin).all() {
                let cell = at.y as usize * self.stride + at.x as usize;
                self.cells[cell] = copy.into();
            }
        }
    }
}

/// A grid of cells at least as wide as the reach of a question, each with a list of its points.
pub(super) struct CellList {
    area: Rect,
    torus: bool,
    reach: f64,
    side: DVec2,
    cols: usize,
    rows: usize,
    /// First point of each cell's list, [`NONE`] at its end.
    head: Vec<u32>,
    next: Vec<u32>,
    points: Vec<DVec2>,
}

const NONE: u32 = u32::MAX;

impl CellList {
    /// An empty grid for about `count` points in `area`, asked about points within `reach`.
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

    /// A grid that holds all points.
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

    /// Calls `visit` with every point that may be within the reach: its number in the order of
    /// insertion and its offset from `p`, the shorter way round on a torus.
    pub(super) fn visit(&self, p: DVec2, mut visit: impl FnMut(u32, DVec2)) {
        self.any(p, |i, offset| {
            visit(i, offset);
            false
        });
    }

    /// Distance in metres from `p` to the nearest point but number `except`; infinite when there is
    /// none. Looks ring by ring around the cell of `p`.
    pub(super) fn nearest(&self, p: DVec2, except: u32) -> f64 {
        let (col, row) = self.cell(p);
        let (cols, rows) = (self.cols as i64, self.rows as i64);
        let mut best = f64::INFINITY;
        for ring in 0..=cols.max(rows) {
            // A point in this ring is at least this far away.
            if (ring - 1) as f64 * self.side.min_element() > best {
                break;
            }
            for dy in -ring..=ring {
                let step = if dy.abs() == ring { 1 } else { (2 * ring).max(1) };
                for dx in (-ring..=ring).step_by(step as usize) {
                    let (x, y) = (col as i64 + dx, row as i64 + dy);
                    let inside = (0..cols).contains(&x) && (0..rows).contains(&y);
                    if !inside && !self.torus {
                        continue;
                    }
                    let cell = y.rem_euclid(rows) * cols + x.rem_euclid(cols);
                    let mut i = self.head[cell as usize];
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

    fn any(&self, p: DVec2, mut found: impl FnMut(u32, DVec2) -> bool) -> bool {
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
        let offset = to - from;
        if !self.torus {
            return offset;
        }
        let size = self.area.size();
        offset - size * (offset / size).round()
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let cell = (p - self.area.min) / self.side;
        ((cell.x as usize).min(self.cols - 1), (cell.y as usize).min(self.rows - 1))
    }
}

impl Standing for CellList {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_grids_agree_with_brute_force(
            points in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..80),
            width in 2.0..20.0_f64,
            height in 2.0..20.0_f64,
            distance in 0.05..1.0_f64,
            torus: bool,
        ) {
            let area = Rect::new(DVec2::new(-1.0, 3.0), DVec2::new(width - 1.0, height + 3.0));
            let mut fine = FineGrid::new(area, distance, torus);
            let mut coarse = CellList::new(area, distance, points.len() as u64, torus);
            let mut standing: Vec<DVec2> = Vec::new();
            for (x, y) in points {
                let p = area.min + DVec2::new(x, y) * area.size();
                let conflict = standing.iter().any(|&q| {
                    let mut d = (q - p).abs();
                    if torus {
                        d = d.min(area.size() - d);
                    }
                    d.length_squared() < distance * distance
                });
                prop_assert_eq!(coarse.conflicts(p), conflict);
                prop_assert_eq!(fine.conflicts(p), conflict);
                if !conflict {
                    standing.push(p);
                    coarse.insert(p);
                    fine.insert(p);
                }
            }
        }
    }
}
