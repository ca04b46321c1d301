//! The cells that a convex shape touches, or whose centres it covers.

use glam::DVec2;

use super::GridFrame;
use crate::geometry::{Rect, edges};

/// An upper bound of the rounding errors of the borders of rows, relative to the numbers from which they are computed.
const ROUNDING: f64 = 1e-14;

/// A shape that intersects every horizontal strip in one interval.
pub(crate) enum Convex<'a> {
    Disc(DVec2, f64),
    Polygon(&'a [DVec2]),
}

impl GridFrame {
    /// Calls `visit` with the row, the first column and the last column of every run of cells that the shape
    /// touches. In each row, a convex shape covers one interval of x, and every cell of that interval contains a
    /// point of the shape.
    pub(crate) fn touched_runs(
        &self,
        shape: &Convex<'_>,
        mut visit: impl FnMut(usize, usize, usize),
    ) {
        let Some(bounds) = shape.bounds() else { return };
        let (low, high) = (bounds.min.y - self.origin.y, bounds.max.y - self.origin.y);
        let Some((first, last)) = self.touched(low, high, self.rows) else { return };
        for row in first..=last {
            let bottom = self.origin.y + row as f64 * self.cell_size;
            // A row that a point on its border was found in must not lose it by rounding.
            let rounding = ROUNDING * (bottom.abs() + self.cell_size);
            let strip = shape.strip(bottom - rounding, bottom + self.cell_size + rounding);
            let Some((from, to)) = strip else { continue };
            let (from, to) = (from - self.origin.x, to - self.origin.x);
            if let Some((from, to)) = self.touched(from, to, self.cols) {
                visit(row, from, to);
            }
        }
    }

    /// Returns the first and last cell of an axis that a closed interval touches. A point on the line between two
    /// cells belongs to both.
    fn touched(&self, low: f64, high: f64, len: usize) -> Option<(usize, usize)> {
        let first = (low / self.cell_size).ceil() - 1.0;
        let last = (high / self.cell_size).floor();
        if last < 0.0 || first >= len as f64 || first.is_nan() || last.is_nan() {
            return None;
        }
        Some((first.max(0.0) as usize, (last as usize).min(len - 1)))
    }

    /// Returns the first and last cell of an axis whose centres lie in a closed interval, measured from the origin.
    pub(crate) fn middles(&self, low: f64, high: f64, len: usize) -> Option<(usize, usize)> {
        let first = (low / self.cell_size - 0.5).ceil().max(0.0);
        let last = (high / self.cell_size - 0.5).floor().min(len as f64 - 1.0);
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

    /// Returns the interval of x that the shape covers between two heights; `None` if it lies outside them.
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
