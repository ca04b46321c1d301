//! Flood fill: regions of grid cells that are connected by their sides.

use std::ops::Range;

/// Closes the open cells that are connected to `first`, including `first` itself, and reports them run by run. The
/// grid has `cols` cells per row. Every cell is read a few times at most.
pub(crate) fn flood(
    cols: usize,
    open: &mut [bool],
    first: usize,
    mut reached: impl FnMut(Range<usize>),
) {
    // One cell of every run that is still to be visited.
    let mut runs = vec![first];
    while let Some(cell) = runs.pop() {
        if !open[cell] {
            continue;
        }
        let row = cell - cell % cols..(cell - cell % cols + cols).min(open.len());
        let from = (row.start..cell).rev().take_while(|&cell| open[cell]).last().unwrap_or(cell);
        let to = (cell..row.end).take_while(|&cell| open[cell]).last().unwrap_or(cell) + 1;
        open[from..to].fill(false);
        reached(from..to);
        let below = from.checked_sub(cols).map(|from| from..to - cols);
        let above = (from + cols < open.len()).then(|| from + cols..(to + cols).min(open.len()));
        for beside in [below, above].into_iter().flatten() {
            let (begin, open) = (beside.start, &open[beside]);
            let begins = |i: &usize| open[*i] && (*i == 0 || !open[*i - 1]);
            runs.extend((0..open.len()).filter(begins).map(|i| begin + i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_reached_is_what_repeated_spreading_reaches(
            cells in prop::collection::vec(prop::bool::weighted(0.65), 1..60),
            cols in 1..10_usize,
            first in any::<prop::sample::Index>(),
        ) {
            let first = first.index(cells.len());
            let mut left = cells.clone();
            let mut reached = vec![false; cells.len()];
            flood(cols, &mut left, first, |run| {
                for cell in run {
                    assert!(!std::mem::replace(&mut reached[cell], true), "{cell} twice");
                }
            });
            let mut expected = vec![false; cells.len()];
            expected[first] = cells[first];
            for _ in 0..cells.len() {
                for cell in 0..cells.len() {
                    let beside = |other: usize| expected[other] && {
                        let (a, b) = (cell.min(other), cell.max(other));
                        b - a == cols || (b - a == 1 && b % cols != 0)
                    };
                    let joined = (0..cells.len()).any(beside);
                    expected[cell] |= cells[cell] && joined;
                }
            }
            prop_assert_eq!(&reached, &expected);
            let closed: Vec<bool> = cells.iter().zip(&left).map(|(a, b)| *a && !b).collect();
            prop_assert_eq!(closed, reached);
        }
    }
}
