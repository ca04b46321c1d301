//! Total Edge: its count, its mean and its bounds.

use crate::distance::assert_whole_rows;

/// The number of cells whose equal neighbours, at most two each, can be counted in a `u16` without overflow.
const LANE: usize = 1 << 12;

/// Counts the sides between two cells of different class, each side once and without the border: Kuznetsov's Total
/// Edge. Every cell counts as a cell of a class; see [`Adjacency`](super::metrics::Adjacency) for rasters with
/// no-data cells. It takes O(N), in one vectorised pass.
///
/// ```
/// use envgen::landscape::edge_count;
///
/// // 1 1 2
/// // 1 2 2
/// assert_eq!(edge_count(&[1, 1, 2, 1, 2, 2], 3), 3);
/// assert_eq!(edge_count(&[7; 6], 3), 0);
/// ```
///
/// # Panics
/// When the number of cells is not a multiple of `cols`.
#[track_caller]
pub fn edge_count(cells: &[u16], cols: usize) -> u64 {
    assert_whole_rows(cells.len(), cols);
    if cells.is_empty() {
        return 0;
    }
    let mut rows = cells.chunks_exact(cols);
    let Some(first) = rows.next() else { return 0 };
    let mut sum = first.windows(2).filter(|pair| pair[0] != pair[1]).count() as u64;
    let mut above = first;
    for row in rows {
        let (left, last) = row.split_at(cols - 1);
        // Equal pairs are counted: a comparison gives -1 for them, which is subtracted as it is.
        let equal: u64 = left
            .chunks(LANE)
            .zip(row[1..].chunks(LANE))
            .zip(above.chunks(LANE))
            .map(|((cells, right), above)| {
                let sides = cells.iter().zip(right).zip(above);
                let lane: u16 =
                    sides.map(|((c, r), a)| u16::from(c == r) + u16::from(c == a)).sum();
                u64::from(lane)
            })
            .sum();
        sum += 2 * left.len() as u64 - equal + u64::from(last[0] != above[cols - 1]);
        above = row;
    }
    sum
}

/// Returns the number of inner cell sides of a grid, which is the Total Edge if all neighbours differ.
///
/// ```
/// use envgen::landscape::inner_sides;
///
/// // Two rows of three cells: four sides within rows, three between them.
/// assert_eq!(inner_sides(2, 3), 7);
/// ```
pub fn inner_sides(rows: u64, cols: u64) -> u64 {
    rows * cols.saturating_sub(1) + cols * rows.saturating_sub(1)
}

/// Returns the exact mean of the Total Edge over all arrangements of the counts. Each inner side joins two cells of
/// different class with probability 1 - sum n (n - 1) / (N (N - 1)).
///
/// It replaces the fit in Kuznetsov (2017), section 4; see
/// [`published::random_ted`](super::published::random_ted).
///
/// ```
/// use envgen::Seed;
/// use envgen::landscape::{edge_count, mean_edge_count, random_fill};
///
/// let counts = [200, 120, 80];
/// let edges = |seed| edge_count(&random_fill(&counts, Seed(seed)), 20);
/// let mean = (0..100).map(edges).sum::<u64>() as f64 / 100.0;
/// assert!((mean / mean_edge_count(20, 20, &counts) - 1.0).abs() < 0.02);
/// ```
pub fn mean_edge_count(rows: u64, cols: u64, counts: &[u32]) -> f64 {
    let cells = (rows * cols) as f64;
    if cells < 2.0 {
        return 0.0;
    }
    let alike: f64 = counts.iter().map(|&n| f64::from(n) * (f64::from(n) - 1.0)).sum();
    inner_sides(rows, cols) as f64 * (1.0 - alike / (cells * (cells - 1.0)))
}

/// Returns the least number of inner sides between `k` cells of a grid and the others: that of a block in a corner,
/// of a strip across the grid, or of the other cells as a block, whichever is least.
pub fn least_cut(rows: u64, cols: u64, k: u64) -> u64 {
    let cells = rows * cols;
    if k == 0 || k >= cells {
        return 0;
    }
    let strip = |across: u64| across + u64::from(!k.is_multiple_of(across));
    let one = |k: u64| {
        // A block of a rows and ceil(k / a) columns: the sum is least near the square.
        let (low, high) = (k.div_ceil(cols), rows.min(k));
        let root = k.isqrt();
        (low <= high)
            .then(|| {
                [root, root + 1, low, high].map(|a| a.clamp(low, high)).map(|a| a + k.div_ceil(a))
            })
            .and_then(|sums| sums.into_iter().min())
            .unwrap_or(u64::MAX)
    };
    one(k).min(one(cells - k)).min(strip(cols)).min(strip(rows))
}

/// Returns a lower bound of the Total Edge over all arrangements of the counts: every class has at least its least
/// cut, and each side counts for two classes.
///
/// ```
/// use envgen::landscape::{edge_count, edge_lower_bound, edge_upper_bound};
///
/// // Two classes of eight cells on 4 x 4: two halves are best, a checkerboard is worst.
/// let halves: Vec<u16> = (0..16).map(|i| 1 + u16::from(i >= 8)).collect();
/// assert_eq!(edge_lower_bound(4, 4, &[8, 8]), edge_count(&halves, 4));
/// let checkerboard: Vec<u16> = (0..16).map(|i| 1 + (i + i / 4) % 2).collect();
/// assert_eq!(edge_upper_bound(4, 4, &[8, 8]), edge_count(&checkerboard, 4));
/// ```
pub fn edge_lower_bound(rows: u64, cols: u64, counts: &[u32]) -> u64 {
    counts.iter().map(|&n| least_cut(rows, cols, u64::from(n))).sum::<u64>().div_ceil(2)
}

/// Returns an upper bound of the Total Edge over all arrangements of the counts. Each side that counts has an end
/// outside the largest class, and the other cells cover the most sides if they are on one colour of the
/// checkerboard, where no two are neighbours. It is 0 for a grid without cells.
pub fn edge_upper_bound(rows: u64, cols: u64, counts: &[u32]) -> u64 {
    if rows == 0 || cols == 0 {
        return 0;
    }
    let largest = counts.iter().copied().max().unwrap_or(0);
    let others = rows * cols - u64::from(largest).min(rows * cols);
    let cover = |colour: u64| {
        let mut left = others;
        degrees(rows, cols, colour)
            .into_iter()
            .map(|(degree, many)| {
                let taken = left.min(many);
                left -= taken;
                degree * taken
            })
            .sum::<u64>()
            + if left > 0 { inner_sides(rows, cols) } else { 0 }
    };
    cover(0).max(cover(1)).min(inner_sides(rows, cols))
}

/// Returns, for a colour of the checkerboard (0 contains the top left cell), numbers of neighbours with the number
/// of cells that have as many, most neighbours first. The grid must have cells.
fn degrees(rows: u64, cols: u64, colour: u64) -> Vec<(u64, u64)> {
    // Cells of one colour among `n` in a line that begins with colour `first`.
    let in_line = |n: u64, first: u64| if first == colour { n.div_ceil(2) } else { n / 2 };
    let in_block = |r: u64, c: u64, first: u64| {
        r.div_ceil(2) * in_line(c, first) + r / 2 * in_line(c, 1 - first)
    };
    if rows == 1 || cols == 1 {
        let n = rows * cols;
        let all = in_line(n, 0);
        let end = |at: u64| u64::from(at % 2 == colour);
        let ends = if n == 1 { end(0) } else { end(0) + end(n - 1) };
        return vec![(2, all - ends), (u64::from(n > 1), ends)];
    }
    let inner = in_block(rows - 2, cols - 2, 0);
    let corners = [0, cols - 1, rows - 1, rows + cols - 2];
    let corners = corners.into_iter().filter(|at| at % 2 == colour).count() as u64;
    let all = in_block(rows, cols, 0);
    vec![(4, inner), (3, all - inner - corners), (2, corners)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::random_fill;
    use crate::seed::Seed;
    use proptest::prelude::*;

    /// One cell side after the other.
    fn slow_edge_count(cells: &[u16], cols: usize) -> u64 {
        let rows = cells.len() / cols;
        let mut sum = 0;
        for r in 0..rows {
            for c in 0..cols {
                let at = |r: usize, c: usize| cells[r * cols + c];
                sum += u64::from(c + 1 < cols && at(r, c) != at(r, c + 1));
                sum += u64::from(r + 1 < rows && at(r, c) != at(r + 1, c));
            }
        }
        sum
    }

    const SMALL: [(u64, u64); 9] =
        [(1, 1), (1, 2), (1, 7), (6, 1), (2, 2), (2, 5), (3, 3), (3, 4), (4, 4)];

    #[test]
    fn the_least_cut_is_the_least_of_all_sets() {
        for (rows, cols) in SMALL.into_iter().chain([(2, 8), (3, 5), (5, 3)]) {
            let cells = (rows * cols) as u32;
            let mut least = vec![u64::MAX; cells as usize + 1];
            for set in 0_u32..1 << cells {
                let map: Vec<u16> = (0..cells).map(|i| (set >> i & 1) as u16).collect();
                let cut = slow_edge_count(&map, cols as usize);
                let k = set.count_ones() as usize;
                least[k] = least[k].min(cut);
            }
            for (k, &cut) in least.iter().enumerate() {
                assert_eq!(least_cut(rows, cols, k as u64), cut, "{k} of {rows} x {cols}");
            }
        }
    }

    #[test]
    fn nothing_goes_over_the_upper_bound_and_two_classes_reach_it() {
        for (rows, cols) in SMALL {
            let cells = (rows * cols) as u32;
            let mut most = vec![0; cells as usize + 1];
            for set in 0_u32..1 << cells {
                let map: Vec<u16> = (0..cells).map(|i| (set >> i & 1) as u16).collect();
                let k = set.count_ones() as usize;
                most[k] = most[k].max(slow_edge_count(&map, cols as usize));
            }
            for (k, &edges) in most.iter().enumerate() {
                let counts = [k as u32, cells - k as u32];
                assert_eq!(
                    edge_upper_bound(rows, cols, &counts),
                    edges,
                    "{counts:?} {rows}x{cols}"
                );
            }
        }
    }

    #[test]
    fn grids_without_cells_have_no_edges() {
        for (rows, cols) in [(0, 0), (0, 1), (1, 0), (0, 5), (5, 0)] {
            for counts in [&[][..], &[0], &[0, 0], &[3, 2]] {
                assert_eq!(edge_upper_bound(rows, cols, counts), 0, "{rows} x {cols}");
                assert_eq!(edge_lower_bound(rows, cols, counts), 0, "{rows} x {cols}");
                assert_eq!(mean_edge_count(rows, cols, counts), 0.0, "{rows} x {cols}");
            }
            assert_eq!((inner_sides(rows, cols), least_cut(rows, cols, 0)), (0, 0));
        }
    }

    #[test]
    fn the_printed_first_row_is_impossible() {
        // Kuznetsov's figure 1 gives TED 0.40842 for S = 0.349119 with 10 classes on 48 x 48,
        // which is TE 941: more than those counts allow, and than the geometric counts do.
        let counts = crate::landscape::Composition::closest(2304, 10, 0.349_119, false);
        let nearest = edge_upper_bound(48, 48, counts.as_ref().unwrap().counts());
        let geometric = edge_upper_bound(48, 48, &[2083, 200, 19, 2]);
        assert!(nearest < 890 && geometric == 884, "{nearest} {geometric}");
    }

    #[test]
    fn the_mean_is_that_of_random_maps() {
        let counts = [900, 500, 200, 100];
        let mean = mean_edge_count(34, 50, &counts);
        let (mut sum, mut squares) = (0.0, 0.0);
        for seed in 0..400 {
            let edges = edge_count(&random_fill(&counts, Seed(seed)), 50) as f64;
            sum += edges / 400.0;
            squares += edges * edges / 400.0;
        }
        let deviation = ((squares - sum * sum) / 400.0).sqrt();
        // False-alarm rate 6e-5.
        assert!((sum - mean).abs() < 4.0 * deviation, "{sum} of {mean} +- {deviation}");
    }

    #[test]
    fn long_rows_do_not_overflow() {
        let cells: Vec<u16> = (0..200_000_u32).map(|i| (i % 2) as u16).collect();
        assert_eq!(edge_count(&cells, 200_000), 199_999);
        assert_eq!(edge_count(&cells, 100_000), 2 * 99_999);
        assert_eq!(edge_count(&[7; 200_000], 100_000), 0);
        assert_eq!(edge_count(&[], 0), 0);
    }

    #[test]
    fn rows_that_are_not_whole_are_a_mistake_of_the_program() {
        use crate::landscape::metrics::{Adjacency, Neighbourhood, patches};
        for (cells, cols) in [(4, 0), (4, 3), (3, 4)] {
            let cells = vec![1; cells];
            let message = format!("{} cells do not fill whole rows of {cols}", cells.len());
            let panics = |count: &dyn Fn()| {
                let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(count));
                let payload = caught.expect_err("it panics");
                assert_eq!(payload.downcast_ref::<String>(), Some(&message));
            };
            panics(&|| {
                edge_count(&cells, cols);
            });
            panics(&|| drop(Adjacency::new(&cells, cols)));
            panics(&|| drop(patches(&cells, cols, Neighbourhood::Four)));
            panics(&|| drop(crate::distance::squared_distances(cols, &vec![true; cells.len()])));
        }
        assert_eq!(edge_count(&[], 0), 0);
        assert!(patches(&[], 0, Neighbourhood::Eight).is_empty());
    }

    proptest! {
        #[test]
        fn counting_agrees_with_the_slow_method(
            cells in prop::collection::vec(0_u16..4, 1..300), cols in 1_usize..40,
        ) {
            let whole = cells.len() / cols * cols;
            prop_assert_eq!(edge_count(&cells[..whole], cols), slow_edge_count(&cells[..whole], cols));
        }

        #[test]
        fn bounds_hold(
            rows in 0_u64..12, cols in 0_u64..12, classes in 1_u16..6, seed: u64,
        ) {
            let mut stream = Seed(seed).stream("test", 0);
            let cells: Vec<u16> =
                (0..rows * cols).map(|_| stream.below(u64::from(classes)) as u16).collect();
            let mut counts = vec![0; usize::from(classes)];
            cells.iter().for_each(|&class| counts[usize::from(class)] += 1);
            let edges = edge_count(&cells, cols as usize);
            prop_assert!(edge_lower_bound(rows, cols, &counts) <= edges);
            prop_assert!(edge_upper_bound(rows, cols, &counts) >= edges);
        }
    }
}
