//! Square cells over an area, and which of them a convex shape touches.

use glam::DVec2;

use crate::geometry::{Rect, edges};

/// The most cells of a lattice that indexes parts: 8 bytes each.
pub(crate) const MAX_CELLS: f64 = (1 << 22) as f64;

/// Square cells in rows over an area; row 0 is the lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) origin: DVec2,
    /// Side of a cell in metres.
    pub(crate) side: f64,
    pub(crate) cols: usize,
    pub(crate) rows: usize,
}

/// A shape that every horizontal strip cuts in one interval.
pub(crate) enum Convex<'a> {
    Disc(DVec2, f64),
    Polygon(&'a [DVec2]),
}

impl Lattice {
    /// About `target` cells over an area, [`MAX_CELLS`] at most.
    pub(crate) fn over(area: Rect, target: f64) -> Lattice {
        let size = area.size();
        let longest = size.max_element();
        let side = (size.x * size.y / target).sqrt().max(longest / MAX_CELLS.sqrt()).min(longest);
        let cells = (size / side).ceil().max(DVec2::ONE);
        Lattice { origin: area.min, side, cols: cells.x as usize, rows: cells.y as usize }
    }

    /// Calls `visit` with row, first and last column of every run of cells that the shape touches.
    /// In each row a convex shape covers one interval of x, and every cell of it holds a point of
    /// the shape.
    pub(crate) fn touched_runs(
        &self,
        shape: &Convex<'_>,
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        let Some(bounds) = shape.bounds() else { return };
        let (low, high) = (bounds.min.y - self.origin.y, bounds.max.y - self.origin.y);
        let Some((first, last)) = self.touched(low, high, self.rows) else { return };
        for row in first..=last {
            let bottom = self.origin.y + row as f64 * self.side;
            let Some((from, to)) = shape.strip(bottom, bottom + self.side) else { continue };
            let (from, to) = (from - self.origin.x, to - self.origin.x);
            if let Some((from, to)) = self.touched(from, to, self.cols) {
                visit(row, from, to);
            }
        }
    }

    /// The first and last cell of an axis that a closed interval touches: a point on the line
    /// between two cells belongs to both.
    fn touched(&self, low: f64, high: f64, len: usize) -> Option<(usize, usize)> {
        let first = (low / self.side).ceil() - 1.0;
        let last = (high / self.side).floor();
        if last < 0.0 || first >= len as f64 || first.is_nan() || last.is_nan() {
            return None;
        }
        Some((first.max(0.0) as usize, (last as usize).min(len - 1)))
    }

    /// The number of the cell around a point, row by row; `None` outside.
    pub(crate) fn cell_at(&self, p: DVec2) -> Option<usize> {
        let cell = ((p - self.origin) / self.side).floor();
        let inside = cell.x >= 0.0
            && cell.y >= 0.0
            && cell.x < self.cols as f64
            && cell.y < self.rows as f64;
        inside.then(|| cell.y as usize * self.cols + cell.x as usize)
    }

    /// The cells whose middles lie in a closed interval of an axis, measured from the origin.
    pub(crate) fn middles(&self, low: f64, high: f64, len: usize) -> Option<(usize, usize)> {
        let first = (low / self.side - 0.5).ceil().max(0.0);
        let last = (high / self.side - 0.5).floor().min(len as f64 - 1.0);
        (first <= last).then_some((first as usize, last as usize))
    }
}

impl Convex<'_> {
    fn bounds(&self) -> Option<Rect> {
        match self {
            Convex::Disc(center, radius) => Some(Rect::new(*center, *center).grown(*radius)),
            Convex::Polygon(points) => Rect::around(points.iter().copied()),
        }
    }

    /// The interval of x that the shape covers between two heights; `None` when it misses them.
    fn strip(&self, bottom: f64, top: f64) -> Option<(f64, f64)> {
        match *self {
            Convex::Disc(center, radius) => {
                let dy = (bottom - center.y).max(center.y - top).max(0.0);
                let half2 = radius * radius - dy * dy;
                (half2 >= 0.0).then(|| (center.x - half2.sqrt(), center.x + half2.sqrt()))
            }
            Convex::Polygon(points) => {
                let mut run: Option<(f64, f64)> = None;
                let mut cover = |x: f64| {
                    run = Some(run.map_or((x, x), |(from, to)| (from.min(x), to.max(x))));
                };
                for (a, b) in edges(points) {
                    if a.y >= bottom && a.y <= top {
                        cover(a.x);
                    }
                    for y in [bottom, top] {
                        if (a.y < y) != (b.y < y) {
                            cover(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
                        }
                    }
                }
                run
            }
        }
    }
}

/// One list per cell, all in one allocation.
#[derive(Clone, Debug)]
pub(crate) struct CellBuckets<T> {
    /// Where each cell's list starts; one more than there are cells.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T> Default for CellBuckets<T> {
    fn default() -> Self {
        CellBuckets { starts: Vec::new(), items: Vec::new() }
    }
}

impl<T: Copy> CellBuckets<T> {
    /// Lists each item in every cell that `runs` names for it; `None` when that would be more than
    /// `most` listings.
    pub(crate) fn build(
        lattice: &Lattice,
        items: &[T],
        most: Option<usize>,
        runs: impl Fn(&T, &Lattice, &mut dyn FnMut(usize, usize, usize)),
    ) -> Option<Self> {
        let mut starts = vec![0_u32; lattice.cols * lattice.rows + 1];
        let mut total = 0;
        for item in items {
            runs(item, lattice, &mut |row, from, to| {
                total += to + 1 - from;
                let cells = row * lattice.cols;
                starts[cells + from..=cells + to].iter_mut().for_each(|count| *count += 1);
            });
            if most.is_some_and(|most| total > most) {
                return None;
            }
        }
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        // Filled from the back, each start moves from the end of its list to its beginning.
        let Some(&any) = items.first() else {
            return Some(CellBuckets { starts, items: Vec::new() });
        };
        let mut listed = vec![any; total];
        for item in items.iter().rev() {
            runs(item, lattice, &mut |row, from, to| {
                let cells = row * lattice.cols;
                for start in &mut starts[cells + from..=cells + to] {
                    *start -= 1;
                    listed[*start as usize] = *item;
                }
            });
        }
        Some(CellBuckets { starts, items: listed })
    }

    #[inline]
    pub(crate) fn of(&self, cell: usize) -> &[T] {
        match self.starts.get(cell..cell + 2) {
            Some(&[from, to]) => &self.items[from as usize..to as usize],
            _ => &[],
        }
    }
}
