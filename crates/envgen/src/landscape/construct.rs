//! Landscapes built by construction: with little Total Edge (bands), with much (checkerboard), and stripes in
//! between.

use super::edge::edge_count;
use crate::seed::Stream;

/// All band heights of a grid are tried if this takes at most this many cell visits.
const EVERY_HEIGHT: usize = 1 << 24;

/// Classes with their counts, in the order in which they are placed.
pub(super) type Runs = Vec<(u16, u32)>;

/// Returns the classes with the greatest count first.
pub(super) fn descending(counts: &[u32]) -> Runs {
    let mut runs: Runs =
        (1..=u16::MAX).zip(counts.iter().copied()).filter(|run| run.1 > 0).collect();
    runs.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(&b.0)));
    runs
}

/// Places runs of classes along a serpentine over horizontal bands of `height` rows, column by column within a
/// band; over vertical bands if `upright` is set.
pub(super) fn bands(
    rows: usize,
    cols: usize,
    runs: impl IntoIterator<Item = (u16, u32)>,
    height: usize,
    upright: bool,
) -> Vec<u16> {
    let mut cells = vec![0; rows * cols];
    let (lines, length) = if upright { (cols, rows) } else { (rows, cols) };
    let (mut runs, mut class, mut left) = (runs.into_iter(), 0, 0);
    let mut next = || {
        while left == 0 {
            let Some((c, n)) = runs.next() else { return class };
            (class, left) = (c, n);
        }
        left -= 1;
        class
    };
    for (k, from) in (0..lines).step_by(height.max(1)).enumerate() {
        let to = (from + height.max(1)).min(lines);
        for i in 0..length {
            let along = if k % 2 == 0 { i } else { length - 1 - i };
            for across in from..to {
                let at = if upright { along * cols + across } else { across * cols + along };
                cells[at] = next();
            }
        }
    }
    cells
}

/// Returns bands whose height suits the larger classes, in random order and direction: a fast start with little
/// Total Edge.
pub(super) fn random_bands(
    rows: usize,
    cols: usize,
    counts: &[u32],
    stream: &mut Stream,
) -> Vec<u16> {
    let mut runs = descending(counts);
    let typical = runs.get(runs.len() / 4).map_or(1, |run| run.1);
    stream.shuffle(&mut runs);
    let upright = stream.chance(0.5);
    let lines = if upright { cols } else { rows };
    let parts = (lines as f64 / f64::from(typical).sqrt()).round().max(1.0) as usize;
    let mut cells = bands(rows, cols, runs, lines.div_ceil(parts), upright);
    if stream.chance(0.5) {
        cells.reverse();
    }
    cells
}

/// Returns the bands of least Total Edge. If the grid is small enough, all heights in both directions are tried,
/// otherwise only heights that divide the grid evenly. It takes O(N) per height.
pub(super) fn best_bands(rows: usize, cols: usize, counts: &[u32]) -> (Vec<u16>, u64) {
    let runs = descending(counts);
    let mut best: Option<(Vec<u16>, u64)> = None;
    for upright in [false, true] {
        let lines = if upright { cols } else { rows };
        let mut heights: Vec<usize> = if rows * cols * (rows + cols) <= EVERY_HEIGHT {
            (1..=lines).collect()
        } else {
            [1, 2, 3, 4, 6, 8, 12, 16, 24].map(|parts| lines.div_ceil(parts)).to_vec()
        };
        heights.dedup();
        for height in heights {
            let cells = bands(rows, cols, runs.iter().copied(), height, upright);
            let edges = edge_count(&cells, cols);
            if best.as_ref().is_none_or(|found| edges < found.1) {
                best = Some((cells, edges));
            }
        }
    }
    best.unwrap_or_default()
}

/// Returns the least Total Edge that bands of these counts have. The search covers every value from here up to
/// [`edge_upper_bound`](super::edge_upper_bound); only few values at the very ends do not exist. For lower values,
/// down to [`edge_lower_bound`](super::edge_lower_bound), it still tries.
pub fn least_built(rows: u64, cols: u64, counts: &[u32]) -> u64 {
    best_bands(rows as usize, cols as usize, counts).1
}

/// Returns rows in which every class is repeated `repeats` times, along a serpentine of height 1.
pub(super) fn stripes(rows: usize, cols: usize, classes: &[(u16, u32)], repeats: u32) -> Vec<u16> {
    // Integer parts of n (i + 1) / repeats: every class's pieces differ by one cell at most.
    let share = |n: u32, i: u32| (u64::from(n) * u64::from(i) / u64::from(repeats)) as u32;
    let runs = (0..repeats).flat_map(|i| {
        classes.iter().map(move |&(class, n)| (class, share(n, i + 1) - share(n, i)))
    });
    bands(rows, cols, runs, 1, false)
}

/// Returns a landscape with much Total Edge. If one class has at least half of the cells, the others are isolated
/// on the cells of one colour of a checkerboard that have the most neighbours. Otherwise the classes fill one
/// colour and then the other, the greatest class first, each colour in random order except for the class that is in
/// both.
pub(super) fn checkerboard(
    rows: usize,
    cols: usize,
    counts: &[u32],
    stream: &mut Stream,
) -> Vec<u16> {
    let runs = descending(counts);
    let total = rows * cols;
    let of_colour = |colour: usize| {
        (0..total).filter(move |at| (at / cols + at % cols) % 2 == colour).collect::<Vec<_>>()
    };
    let largest = runs.first().map_or(0, |run| run.1 as usize);
    let mut places = [of_colour(0), of_colour(1)];
    if 2 * largest >= total {
        let others = total - largest;
        let degree = |at: &usize| neighbours(rows, cols, *at);
        let cover = |places: &Vec<usize>| places.iter().take(others).map(degree).sum::<usize>();
        for list in &mut places {
            stream.shuffle(list);
            list.sort_by_key(|at| std::cmp::Reverse(degree(at)));
        }
        let fits = |list: &Vec<usize>| list.len() >= others;
        let second = !fits(&places[0]) || fits(&places[1]) && cover(&places[1]) > cover(&places[0]);
        let list = &mut places[usize::from(second)];
        list.truncate(others);
        stream.shuffle(list);
        let mut cells = vec![runs.first().map_or(0, |run| run.0); total];
        let small =
            runs.iter().skip(1).flat_map(|&(class, n)| std::iter::repeat_n(class, n as usize));
        for (&at, class) in list.iter().zip(small) {
            cells[at] = class;
        }
        return cells;
    }

    let [first, second] = places;
    let mut classes: Vec<u16> =
        runs.iter().flat_map(|&(class, n)| std::iter::repeat_n(class, n as usize)).collect();
    let half = first.len();
    // The class on both colours stays at the end of one and the beginning of the other, which are
    // far from each other.
    let shared =
        (half < total && half > 0 && classes[half - 1] == classes[half]).then(|| classes[half]);
    let end = classes[..half].iter().position(|&c| Some(c) == shared).unwrap_or(half);
    let begin =
        half + classes[half..].iter().position(|&c| Some(c) != shared).unwrap_or(total - half);
    stream.shuffle(&mut classes[..end]);
    stream.shuffle(&mut classes[begin..]);
    let mut cells = vec![0; total];
    for (&at, class) in first.iter().chain(&second).zip(classes) {
        cells[at] = class;
    }
    cells
}

fn neighbours(rows: usize, cols: usize, at: usize) -> usize {
    let (r, c) = (at / cols, at % cols);
    usize::from(r > 0) + usize::from(r + 1 < rows) + usize::from(c > 0) + usize::from(c + 1 < cols)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::edge::{edge_lower_bound, edge_upper_bound};
    use crate::seed::Seed;
    use proptest::prelude::*;

    #[test]
    fn the_serpentine_is_not_the_minimum() {
        // As Kuznetsov (2017), section 3, says it is.
        let counts = [576; 4];
        let serpentine = bands(48, 48, descending(&counts), 1, false);
        assert_eq!(edge_count(&serpentine, 48), 144);
        assert_eq!(best_bands(48, 48, &counts).1, 96);
        assert_eq!(edge_lower_bound(48, 48, &counts), 96);
    }

    #[test]
    fn a_large_class_leaves_the_upper_bound() {
        for (rows, cols, counts) in [
            (48, 48, vec![2000, 200, 104]),
            (3, 3, vec![5, 2, 2]),
            (3, 3, vec![7, 1, 1]),
            (1, 9, vec![6, 3]),
            (6, 6, vec![18, 18]),
        ] {
            let mut stream = Seed(1).stream("test", 0);
            let cells = checkerboard(rows, cols, &counts, &mut stream);
            let bound = edge_upper_bound(rows as u64, cols as u64, &counts);
            assert_eq!(edge_count(&cells, cols), bound, "{counts:?}");
        }
    }

    proptest! {
        #[test]
        fn counts_are_kept(
            rows in 1_usize..15, cols in 1_usize..15, cuts in prop::collection::vec(0_u32..225, 0..6),
            height in 1_usize..20, upright: bool, repeats in 1_u32..9,
        ) {
            let total = (rows * cols) as u32;
            let mut cuts: Vec<u32> = cuts.into_iter().map(|cut| cut.min(total)).chain([0, total]).collect();
            cuts.sort_unstable();
            let counts: Vec<u32> = cuts.windows(2).map(|w| w[1] - w[0]).collect();
            let mut stream = Seed(1).stream("test", 0);
            for cells in [
                bands(rows, cols, descending(&counts), height, upright),
                random_bands(rows, cols, &counts, &mut stream),
                best_bands(rows, cols, &counts).0,
                stripes(rows, cols, &descending(&counts), repeats),
                checkerboard(rows, cols, &counts, &mut stream),
            ] {
                let mut found = vec![0; counts.len()];
                cells.iter().for_each(|&class| found[usize::from(class) - 1] += 1);
                prop_assert_eq!(&found, &counts);
            }
        }
    }
}
