//! Algorithm 2, repaired to a Total Edge.

use super::grid::{Arranged, Grid};
use crate::landscape::automaton::automaton_fill;
use crate::landscape::edge::edge_count;
use crate::landscape::error::LandscapeError;
use crate::landscape::spec::Algorithm;
use crate::seed::Seed;

/// The probability of an extra change where nothing determines another value.
const EPSILON: f64 = 0.1;

/// The automaton's landscape, with a Total Edge or without.
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

/// The `epsilon` whose automaton landscapes have the wanted mean Total Edge Density, by bisection
/// on means of `maps` simulated landscapes; 0 or 1 where the wanted density is out of reach.
pub fn automaton_epsilon(
    rows: usize,
    cols: usize,
    counts: &[u32],
    ted: f64,
    maps: u64,
    seed: Seed,
) -> f64 {
    let maps = maps.max(1);
    let mean = |epsilon: f64| {
        let edges: u64 = (0..maps)
            .map(|i| {
                let grid = Grid { rows, cols, counts, seed: seed.offset(i) };
                edge_count(&fill(&grid, epsilon).cells, cols)
            })
            .sum();
        edges as f64 / (maps as f64 * (rows * cols) as f64)
    };
    bisect(|epsilon| mean(epsilon) < ted, 20)
}

/// The number in [0, 1] up to which `below` holds, halved `steps` times.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn epsilon_is_found_for_a_density() {
        let composition = crate::landscape::Composition::closest(2304, 9, 1.9, false).unwrap();
        let counts = composition.counts();
        let epsilon = automaton_epsilon(48, 48, counts, 0.862, 20, Seed(1));
        assert!((epsilon - 0.2).abs() < 0.03, "{epsilon}");
        assert_eq!(automaton_epsilon(48, 48, counts, 0.0, 2, Seed(1)), 0.0);
        assert_eq!(automaton_epsilon(48, 48, counts, 5.0, 2, Seed(1)), 1.0);
    }
}
