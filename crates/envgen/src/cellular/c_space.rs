//! Configuration space: the cells in which a robot's centre can be, and their regions.

use crate::flood::flood;

/// Returns for each cell whether a robot cannot be in it: whether there is a filled cell in the square of `radius`
/// cells around it. Cells beyond the grid are not filled. The grid has `cols` cells per row. It takes time
/// proportional to the number of cells.
///
/// ```
/// use envgen::cellular::c_space;
///
/// let blocked = c_space(5, &[false, false, false, false, true], 1);
/// assert_eq!(blocked, [false, false, false, true, true]);
/// ```
///
/// # Panics
/// When the cells do not fill whole rows.
#[track_caller]
pub fn c_space(cols: usize, filled: &[bool], radius: usize) -> Vec<bool> {
    crate::distance::assert_whole_rows(filled.len(), cols);
    if cols == 0 {
        return Vec::new();
    }
    // The square is a row of columns: first along the rows, then along the columns.
    let mut along = vec![false; filled.len()];
    for (row, along) in filled.chunks_exact(cols).zip(along.chunks_exact_mut(cols)) {
        spread(cols, radius, |i| row[i], |i| along[i] = true);
    }
    let mut blocked = vec![false; filled.len()];
    for col in 0..cols {
        let cell = |i: usize| i * cols + col;
        spread(filled.len() / cols, radius, |i| along[cell(i)], |i| blocked[cell(i)] = true);
    }
    blocked
}

/// Marks the cells of a row or column that have a filled cell at most `radius` cells away.
fn spread(len: usize, radius: usize, filled: impl Fn(usize) -> bool, mut mark: impl FnMut(usize)) {
    let mut marked = 0;
    for i in (0..len).filter(|&i| filled(i)) {
        let end = i.saturating_add(radius).saturating_add(1).min(len);
        (marked.max(i.saturating_sub(radius))..end).for_each(&mut mark);
        marked = end;
    }
}

/// Returns for each cell the number of its region, counted from 1, or 0 where a robot cannot be; and the sizes of
/// the regions, with that of region `k` at index `k - 1`. Cells are joined by their sides.
pub(super) fn regions(cols: usize, blocked: &[bool]) -> (Vec<u32>, Vec<u32>) {
    let mut open: Vec<bool> = blocked.iter().map(|blocked| !blocked).collect();
    let (mut numbers, mut sizes) = (vec![0; blocked.len()], Vec::new());
    for first in 0..blocked.len() {
        if open[first] {
            let (number, mut size) = (sizes.len() as u32 + 1, 0);
            flood(cols, &mut open, first, |run| {
                size += run.len() as u32;
                numbers[run].fill(number);
            });
            sizes.push(size);
        }
    }
    (numbers, sizes)
}
