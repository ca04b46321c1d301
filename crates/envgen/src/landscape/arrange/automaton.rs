//! Algorithm 2: the probabilistic cellular automaton, rule R0, and its repair to a Total Edge.

use super::grid::{Arranged, Grid};
use crate::landscape::edge::edge_count;
use crate::landscape::error::LandscapeError;
use crate::landscape::spec::Algorithm;
use crate::seed::Stream;

/// The default probability of an extra change, if nothing determines another value.
const EPSILON: f64 = 0.1;

/// Arranges a landscape by the automaton, with or without a requested Total Edge.
pub(super) fn arrange(
    grid: &Grid<'_>,
    target: Option<u64>,
    epsilon: Option<f64>,
) -> Result<Arranged, LandscapeError> {
    match target {
        None => Ok(fill(grid, epsilon.unwrap_or(EPSILON))),
        Some(target) => towards(grid, target, epsilon),
    }
}

fn fill(grid: &Grid<'_>, epsilon: f64) -> Arranged {
    let mut stream = grid.seed.stream("landscape/automaton", 0);
    let cells = automaton_fill(grid.rows, grid.cols, grid.counts, epsilon, &mut stream);
    Arranged { epsilon: Some(epsilon), ..Arranged::plain(cells) }
}

fn towards(grid: &Grid<'_>, target: u64, epsilon: Option<f64>) -> Result<Arranged, LandscapeError> {
    let edges = |epsilon: f64| edge_count(&fill(grid, epsilon).cells, grid.cols);
    let epsilon = match epsilon {
        Some(epsilon) => epsilon,
        None => {
            let (low, high) = (edges(0.0), edges(1.0));
            if !(low..=high).contains(&target) {
                let algorithm = Algorithm::Automaton;
                return Err(LandscapeError::Look { algorithm, low, high, target });
            }
            // A step changes few cells of a large map, and a swap repairs four or so.
            bisect(|epsilon| edges(epsilon) <= target, 16)
        }
    };
    let start = fill(grid, epsilon);
    Ok(Arranged { epsilon: Some(epsilon), ..grid.repaired(&start.cells, target) })
}

/// Finds by bisection the number in [0, 1] up to which `below` holds, in `steps` halvings.
fn bisect(mut below: impl FnMut(f64) -> bool, steps: u32) -> f64 {
    if !below(0.0) {
        return 0.0;
    }
    if below(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..steps {
        let middle = 0.5 * (low + high);
        if below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Fills a grid cell by cell in serpentine order. Each cell keeps the class of the previous cell. With probability
/// `epsilon`, or if that class has no cells left, it takes a class drawn uniformly from the other classes that have
/// cells left (Kuznetsov 2017, section 3). Class `k + 1` gets `counts[k]` cells; the counts must fill the grid. It
/// takes O(1) per cell, whatever the number of classes is.
///
/// The paper describes its rule as "out of turn with probability epsilon"; its formula leaves open whether the
/// drawn class may be that of the previous cell. R0 is the reading in which it may not.
///
/// # Panics
/// When the counts do not fill the grid, or when `epsilon` is not a probability.
#[track_caller]
pub fn automaton_fill(
    rows: usize,
    cols: usize,
    counts: &[u32],
    epsilon: f64,
    stream: &mut Stream,
) -> Vec<u16> {
    let filled: u64 = counts.iter().map(|&n| u64::from(n)).sum();
    assert!(filled == (rows * cols) as u64, "{filled} cells do not fill {rows} rows of {cols}");
    assert!((0.0..=1.0).contains(&epsilon), "`epsilon` must be a probability, got {epsilon}");
    let mut cells = vec![0; rows * cols];
    let mut reserve = Reserve::new(counts);
    let Some(mut class) = reserve.draw(None, stream) else { return cells };
    reserve.take(class);
    let mut first = true;
    for (r, row) in cells.chunks_exact_mut(cols.max(1)).enumerate() {
        let mut step = |cell: &mut u16| {
            if first {
                first = false;
            } else {
                let u = stream.unit();
                let keep = reserve.left(class) && u >= epsilon;
                if !keep && let Some(other) = reserve.draw(Some(class), stream) {
                    class = other;
                }
                reserve.take(class);
            }
            *cell = class as u16 + 1;
        };
        if r % 2 == 0 {
            row.iter_mut().for_each(&mut step);
        } else {
            row.iter_mut().rev().for_each(&mut step);
        }
    }
    cells
}

/// The classes that have cells left, as a list from which a class can be removed in O(1).
struct Reserve {
    left: Vec<u32>,
    list: Vec<u32>,
    place: Vec<u32>,
}

impl Reserve {
    fn new(counts: &[u32]) -> Self {
        let mut place = vec![0; counts.len()];
        let mut list = Vec::new();
        for (k, _) in counts.iter().enumerate().filter(|(_, n)| **n > 0) {
            place[k] = list.len() as u32;
            list.push(k as u32);
        }
        Reserve { left: counts.to_vec(), list, place }
    }

    fn left(&self, class: usize) -> bool {
        self.left[class] > 0
    }

    /// Draws uniformly a class that has cells left and is not `but`; `None` if there are no such classes.
    #[inline]
    fn draw(&self, but: Option<usize>, stream: &mut Stream) -> Option<usize> {
        let skipped = but.filter(|&class| self.left(class)).map(|class| self.place[class] as usize);
        let others = self.list.len() - usize::from(skipped.is_some());
        if others == 0 {
            return None;
        }
        let mut i = stream.below(others as u64) as usize;
        if skipped.is_some_and(|at| i >= at) {
            i += 1;
        }
        Some(self.list[i] as usize)
    }

    #[inline]
    fn take(&mut self, class: usize) {
        self.left[class] -= 1;
        if self.left[class] == 0 {
            let at = self.place[class] as usize;
            self.list.swap_remove(at);
            if let Some(&moved) = self.list.get(at) {
                self.place[moved as usize] = at as u32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::Composition;
    use crate::seed::Seed;
    use proptest::prelude::*;

    #[test]
    fn means_are_those_of_the_specification() {
        // 50 seeds each, 48 x 48, l = 9, S = 1.9, descending counts in shuffled order; single maps
        // spread by up to 0.05, their mean by 0.007: four of that, and half a digit.
        let composition = Composition::closest(48 * 48, 9, 1.9, false).unwrap();
        for (epsilon, mean) in [
            (0.0, 0.164),
            (0.01, 0.388),
            (0.05, 0.670),
            (0.1, 0.755),
            (0.2, 0.862),
            (0.5, 1.156),
            (0.9, 1.521),
            (1.0, 1.654),
        ] {
            let total: u64 = (0..50)
                .map(|seed| {
                    let mut stream = Seed(seed).stream("landscape/automaton", 0);
                    let cells = automaton_fill(48, 48, composition.counts(), epsilon, &mut stream);
                    edge_count(&cells, 48)
                })
                .sum();
            let found = total as f64 / 50.0 / 2304.0;
            assert!((found - mean).abs() < 0.03, "epsilon {epsilon}: {found}, printed {mean}");
        }
    }

    #[test]
    fn without_chance_the_classes_follow_each_other() {
        let mut stream = Seed(1).stream("landscape/automaton", 0);
        let cells = automaton_fill(2, 3, &[3, 3], 0.0, &mut stream);
        assert_eq!(&cells[..3], [cells[0]; 3]);
        assert_eq!(&cells[3..], [cells[3]; 3]);
    }

    proptest! {
        #[test]
        fn counts_are_kept_and_certain_changes_alternate(
            counts in prop::collection::vec(0_u32..30, 1..12), epsilon in 0.0..=1.0_f64, seed: u64,
        ) {
            let cells: u32 = counts.iter().sum();
            prop_assume!(cells > 0);
            let mut stream = Seed(seed).stream("landscape/automaton", 0);
            let filled = automaton_fill(1, cells as usize, &counts, epsilon, &mut stream);
            let mut found = vec![0; counts.len()];
            filled.iter().for_each(|&class| found[usize::from(class) - 1] += 1);
            prop_assert_eq!(found, counts.clone());

            let mut left = counts;
            let filled = automaton_fill(1, cells as usize, &left, 1.0, &mut stream);
            for pair in filled.windows(2) {
                left[usize::from(pair[0]) - 1] -= 1;
                let others = left.iter().enumerate().any(|(k, &n)| n > 0 && k + 1 != usize::from(pair[0]));
                prop_assert!(pair[0] != pair[1] || !others);
            }
        }
    }
}
