//! Exact Euclidean distances on a grid.

/// The greatest distance that is measured, in cells. Cells that are farther away count as this far.
const FAR: u8 = u8::MAX;

/// The squared distance of cells that are 255 cells away or more.
pub const FAR_SQUARED: u16 = u16::MAX;

/// Returns, for every cell of a grid, the squared distance in cells from its centre to the centre of the nearest
/// marked cell; [`FAR_SQUARED`] where no marked cell is within 255 cells. The grid is given row by row and has
/// `cols` columns.
///
/// The transform first computes distances along columns, then for each row the lower envelope of the parabolas that
/// these give: Felzenszwalb and Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8
/// (2012), <https://doi.org/10.4086/toc.2012.v008a019>, in whole numbers as in Meijster, Roerdink and Hesselink
/// (2000), <https://doi.org/10.1007/0-306-47025-X_36>. It takes time proportional to the number of cells.
///
/// ```
/// use envgen::distance::squared_distances;
///
/// // Two rows of three cells; the first is marked.
/// let marked = [true, false, false, false, false, false];
/// assert_eq!(squared_distances(3, &marked), [0, 1, 4, 1, 2, 5]);
/// ```
///
/// # Panics
/// When the number of cells is not a multiple of `cols`.
#[track_caller]
pub fn squared_distances(cols: usize, marked: &[bool]) -> Vec<u16> {
    assert_whole_rows(marked.len(), cols);
    let mut along = vec![FAR; marked.len()];
    let mut squared = vec![FAR_SQUARED; marked.len()];
    if cols == 0 {
        return squared;
    }
    let rows = marked.len() / cols;
    let mut last = vec![FAR; cols];
    let mut sweep = |row: usize| {
        let cells = row * cols..(row + 1) * cols;
        for ((last, along), &marked) in
            last.iter_mut().zip(&mut along[cells.clone()]).zip(&marked[cells])
        {
            *last = if marked { 0 } else { last.saturating_add(1) };
            *along = (*along).min(*last);
        }
    };
    (0..rows).for_each(&mut sweep);
    // The first sweep leaves distances to marked cells too, so the second continues from them.
    (0..rows).rev().for_each(sweep);

    // The columns whose parabolas form the envelope, and where each begins.
    let mut envelope: Vec<(i64, i64, i64)> = Vec::with_capacity(cols);
    for (along, squared) in along.chunks_exact(cols).zip(squared.chunks_exact_mut(cols)) {
        envelope.clear();
        for (col, &height) in (0..).zip(along).filter(|(_, height)| **height < FAR) {
            let height = i64::from(height) * i64::from(height);
            let mut from = 0;
            while let Some(&(other, other_height, other_from)) = envelope.last() {
                let squared_to = |x: i64| (x - col) * (x - col) + height;
                let squared_to_other = (other_from - other) * (other_from - other) + other_height;
                if squared_to(other_from) <= squared_to_other {
                    envelope.pop();
                    continue;
                }
                // The first column where this parabola lies lower than the other.
                let rise = col * col - other * other + height - other_height;
                from = rise.div_euclid(2 * (col - other)) + 1;
                break;
            }
            if (from as usize) < cols {
                envelope.push((col, height, from));
            }
        }
        let mut end = cols;
        for &(col, height, from) in envelope.iter().rev() {
            for (x, squared) in (from..).zip(&mut squared[from as usize..end]) {
                let exact = (x - col) * (x - col) + height;
                *squared = u16::try_from(exact).unwrap_or(FAR_SQUARED);
            }
            end = from as usize;
        }
    }
    squared
}

/// Asserts that cells given row by row fill whole rows of `cols` columns. An empty grid fits any `cols`.
#[track_caller]
pub(crate) fn assert_whole_rows(cells: usize, cols: usize) {
    assert!(
        cells == 0 || cells.is_multiple_of(cols),
        "{cells} cells do not fill whole rows of {cols}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn far_cells_are_as_far_as_can_be_represented() {
        let mut marked = vec![false; 600];
        assert!(squared_distances(600, &marked).iter().all(|&d| d == FAR_SQUARED));
        marked[0] = true;
        let row = squared_distances(600, &marked);
        let column = squared_distances(1, &marked);
        assert_eq!(row[254], 254 * 254);
        assert_eq!(column[254], 254 * 254);
        assert_eq!((row[300], column[300]), (FAR_SQUARED, FAR_SQUARED));
        assert!(squared_distances(0, &[]).is_empty());
    }

    proptest! {
        #[test]
        fn distances_are_those_of_brute_force(
            cols in 1..24_usize,
            marks in prop::collection::vec(prop::bool::weighted(0.08), 1..400),
        ) {
            let rows = marks.len().div_ceil(cols);
            let mut marked = marks;
            marked.resize(rows * cols, false);
            let found = squared_distances(cols, &marked);
            let place = |cell: usize| ((cell % cols) as i32, (cell / cols) as i32);
            for (cell, &found) in found.iter().enumerate() {
                let (x, y) = place(cell);
                let nearest = (0..marked.len()).filter(|&other| marked[other]).map(|other| {
                    let (u, v) = place(other);
                    (x - u) * (x - u) + (y - v) * (y - v)
                });
                let expected = nearest.min().map_or(FAR_SQUARED, |d| d as u16);
                prop_assert_eq!(found, expected);
            }
        }
    }
}
