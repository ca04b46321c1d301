//! Lists of items by grid cell.

use glam::DVec2;

use super::GridFrame;
use crate::geometry::Rect;

/// The greatest number of cells of a grid that indexes parts; each cell takes 8 bytes.
pub(crate) const MAX_CELLS: f64 = (1 << 22) as f64;

impl GridFrame {
    /// Creates a frame of about `target` cells over an area, but at most [`MAX_CELLS`].
    pub(crate) fn over(area: Rect, target: f64) -> GridFrame {
        let size = area.size();
        let longest = size.max_element();
        let side = (size.x * size.y / target).sqrt().max(longest / MAX_CELLS.sqrt()).min(longest);
        let cells = (size / side).ceil().max(DVec2::ONE);
        let (cols, rows) = (cells.x as usize, cells.y as usize);
        GridFrame { origin: area.min, cell_size: side, cols, rows }
    }
}

/// Returns the area of an index of items within some bounds, for queries up to `reach` metres from them. A small
/// margin keeps items on the border, and queries that graze it, inside the area.
pub(crate) fn index_area(bounds: Option<Rect>, reach: f64) -> Rect {
    let bounds = bounds.unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
    bounds.grown(reach + 1e-9 * (1.0 + bounds.size().max_element()))
}

/// Returns the first of several frames over an area for which `build` succeeds. The first frame has about `cells`
/// cells, and each further one a quarter of the cells of the one before. `build` receives `most` as the limit of
/// listings; for a single cell it receives no limit and must succeed.
pub(crate) fn finest_frame<T>(
    area: Rect,
    cells: f64,
    most: Option<usize>,
    mut build: impl FnMut(&GridFrame, Option<usize>) -> Option<T>,
) -> (GridFrame, T) {
    let mut target = cells.max(1.0);
    loop {
        let frame = GridFrame::over(area, target);
        let most = most.filter(|_| frame.len() > 1);
        if let Some(built) = build(&frame, most) {
            return (frame, built);
        }
        target *= 0.25;
    }
}

/// Numbered items, listed by the cells of a grid.
#[derive(Clone, Debug)]
pub(crate) struct GridIndex {
    pub(crate) frame: GridFrame,
    lists: CellBuckets<u32>,
}

impl GridIndex {
    /// Lists the items 0 to `len` - 1 in every cell that `runs` names for them, in a grid of about `cells` cells
    /// over an area. The cells are coarser if an item would be listed in more than `listings` of them on average,
    /// so that memory is bounded where items overlap.
    pub(crate) fn new(
        area: Rect,
        cells: f64,
        len: usize,
        listings: Option<usize>,
        runs: impl Fn(usize, &GridFrame, &mut dyn FnMut(usize, usize, usize)),
    ) -> Self {
        let numbers: Vec<u32> = (0..len as u32).collect();
        let most = listings.map(|listings| listings * len);
        let (frame, lists) = finest_frame(area, cells, most, |frame, most| {
            let runs = |&i: &u32, frame: &GridFrame, visit: &mut dyn FnMut(usize, usize, usize)| {
                runs(i as usize, frame, visit);
            };
            CellBuckets::build(frame, &numbers, most, runs)
        });
        GridIndex { frame, lists }
    }

    /// Returns the items that the cell around a point lists, in order; an empty list outside the area.
    #[inline]
    pub(crate) fn at(&self, p: DVec2) -> &[u32] {
        self.frame.index_at(p).map_or(&[], |cell| self.lists.of(cell))
    }

    /// Returns the items that a cell lists, in order.
    #[inline]
    pub(crate) fn of(&self, cell: usize) -> &[u32] {
        self.lists.of(cell)
    }
}

/// One list per cell, all in a single allocation.
#[derive(Clone, Debug)]
pub(crate) struct CellBuckets<T> {
    /// The start of each cell's list, and the end of the last list.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy> CellBuckets<T> {
    /// Lists each item in every cell that `runs` names for it; `None` if that gives more than `most` listings.
    pub(crate) fn build(
        frame: &GridFrame,
        items: &[T],
        most: Option<usize>,
        runs: impl Fn(&T, &GridFrame, &mut dyn FnMut(usize, usize, usize)),
    ) -> Option<Self> {
        let mut starts = vec![0_u32; frame.len() + 1];
        let mut total = 0;
        for item in items {
            runs(item, frame, &mut |row, from, to| {
                total += to + 1 - from;
                let cells = row * frame.cols;
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
            runs(item, frame, &mut |row, from, to| {
                let cells = row * frame.cols;
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
