//! From a spec and a seed to a landscape.

use super::automaton::automaton_fill;
use super::blueprint::Landscape;
use super::construct::{best_bands, checkerboard, descending, random_bands, stripes};
use super::edge::{edge_count, mean_edge_count};
use super::random_fill::random_fill;
use super::search::Board;
use super::smooth::Noise;
use super::spec::{Algorithm, ClassOrder, LandscapeError, LandscapeSpec};
use crate::error::GenerateError;
use crate::seed::Seed;

/// Defaults of the automaton and the smoothing where no Total Edge determines another value.
const EPSILON: f64 = 0.1;
const SIGMA: f64 = 3.0;

/// The result of an arrangement besides the cells.
struct Arranged {
    cells: Vec<u16>,
    epsilon: Option<f64>,
    sigma: Option<f64>,
    swaps: u64,
}

impl Arranged {
    fn plain(cells: Vec<u16>) -> Self {
        Arranged { cells, epsilon: None, sigma: None, swaps: 0 }
    }
}

pub(super) fn landscape(spec: &LandscapeSpec, seed: Seed) -> Result<Landscape, GenerateError> {
    let composition = spec.composition()?;
    let mut counts = composition.counts().to_vec();
    if spec.order == ClassOrder::Shuffled {
        seed.stream("landscape/order", 0).shuffle(&mut counts);
    }
    let grid = Grid { rows: spec.rows as usize, cols: spec.cols as usize, counts: &counts, seed };
    let arranged = match (spec.algorithm, spec.total_edge) {
        (Algorithm::Random | Algorithm::Mixed, None) => Arranged::plain(random_fill(&counts, seed)),
        (Algorithm::Random | Algorithm::Mixed, Some(target)) => {
            grid.mixed(target, spec.swaps_per_cell())
        }
        (Algorithm::Automaton, None) => grid.automaton(spec.epsilon.unwrap_or(EPSILON)),
        (Algorithm::Automaton, Some(target)) => grid.automaton_towards(target, spec.epsilon)?,
        (Algorithm::Bands, None) => Arranged::plain(best_bands(grid.rows, grid.cols, &counts).0),
        (Algorithm::Bands, Some(target)) => grid.bands_towards(target),
        (Algorithm::Smooth, None) => grid.smooth(spec.sigma.unwrap_or(SIGMA)),
        (Algorithm::Smooth, Some(target)) => grid.smooth_towards(target, spec.sigma)?,
    };
    let Arranged { cells, epsilon, sigma, swaps } = arranged;
    Ok(Landscape::new(spec, seed, &composition, counts, cells, (epsilon, sigma, swaps)))
}

/// The least Total Edge that bands of these counts have: every value from here up to
/// [`edge_upper_bound`](super::edge_upper_bound) is searched for, and only few at the very ends do
/// not exist. Below, down to [`edge_lower_bound`](super::edge_lower_bound), the search still
/// tries.
pub fn least_built(rows: u64, cols: u64, counts: &[u32]) -> u64 {
    best_bands(rows as usize, cols as usize, counts).1
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
                edge_count(&grid.automaton(epsilon).cells, cols)
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

struct Grid<'a> {
    rows: usize,
    cols: usize,
    counts: &'a [u32],
    seed: Seed,
}

impl Grid<'_> {
    fn repaired(&self, cells: &[u16], target: u64) -> Arranged {
        let mut board = Board::new(cells, self.cols);
        let swaps = board.seek(target, &mut self.seed.stream("landscape/repair", 0));
        Arranged { swaps, ..Arranged::plain(board.cells()) }
    }

    /// Where to start: bands below the mean of random landscapes, a checkerboard above it. From a
    /// start beyond the target, random swaps approach it quickly; un-mixing is slow.
    fn start(&self, target: u64) -> Vec<u16> {
        let (rows, cols, counts) = (self.rows, self.cols, self.counts);
        if target as f64 > mean_edge_count(rows as u64, cols as u64, counts) {
            let mut stream = self.seed.stream("landscape/checkerboard", 0);
            return checkerboard(rows, cols, counts, &mut stream);
        }
        let mut stream = self.seed.stream("landscape/bands", 0);
        let quick = random_bands(rows, cols, counts, &mut stream);
        if edge_count(&quick, cols) <= target { quick } else { best_bands(rows, cols, counts).0 }
    }

    fn mixed(&self, target: u64, mixing: f64) -> Arranged {
        let mut board = Board::new(&self.start(target), self.cols);
        let mut stream = self.seed.stream("landscape/mixing", 0);
        let mut swaps = board.seek(target, &mut stream);
        if board.edges() == target {
            let attempts = mixing * (self.rows * self.cols) as f64;
            let met = board.cells();
            board.mix(target, attempts as u64, &mut stream);
            swaps += board.seek(target, &mut stream);
            // At the ends of the range the search may not find the target again.
            if board.edges() != target {
                board = Board::new(&met, self.cols);
            }
        }
        Arranged { swaps, ..Arranged::plain(board.cells()) }
    }

    fn automaton(&self, epsilon: f64) -> Arranged {
        let mut stream = self.seed.stream("landscape/automaton", 0);
        let cells = automaton_fill(self.rows, self.cols, self.counts, epsilon, &mut stream);
        Arranged { epsilon: Some(epsilon), ..Arranged::plain(cells) }
    }

    fn automaton_towards(
        &self,
        target: u64,
        epsilon: Option<f64>,
    ) -> Result<Arranged, LandscapeError> {
        let edges = |epsilon: f64| edge_count(&self.automaton(epsilon).cells, self.cols);
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
        let start = self.automaton(epsilon);
        Ok(Arranged { epsilon: Some(epsilon), ..self.repaired(&start.cells, target) })
    }

    /// Bands up to the Total Edge of rows that alternate as often as possible without exceeding the
    /// target; beyond that, and above the mean of random landscapes, as `mixed`.
    fn bands_towards(&self, target: u64) -> Arranged {
        let (rows, cols) = (self.rows, self.cols);
        let mean = mean_edge_count(rows as u64, cols as u64, self.counts);
        if target as f64 > mean {
            return self.mixed(target, 0.0);
        }
        let mut classes = descending(self.counts);
        self.seed.stream("landscape/bands", 0).shuffle(&mut classes);
        let edges = |repeats: u32| edge_count(&stripes(rows, cols, &classes, repeats), cols);
        if edges(1) > target {
            return self.mixed(target, 0.0);
        }
        // More repeats than rows make no more bands of whole rows, and more repeats than the mean number of
        // cells per class leave classes out.
        let most = rows.min(rows * cols / classes.len().max(1)) as u32;
        let (mut low, mut high) = (1, most.max(1) + 1);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if edges(middle) <= target {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.repaired(&stripes(rows, cols, &classes, low), target)
    }

    fn smooth(&self, sigma: f64) -> Arranged {
        let noise = Noise::new(self.rows, self.cols, self.seed);
        let cells = noise.landscape(self.counts, sigma);
        Arranged { sigma: Some(sigma), ..Arranged::plain(cells) }
    }

    fn smooth_towards(&self, target: u64, sigma: Option<f64>) -> Result<Arranged, LandscapeError> {
        let noise = Noise::new(self.rows, self.cols, self.seed);
        let (sigma, cells) = match sigma {
            Some(sigma) => (sigma, noise.landscape(self.counts, sigma)),
            None => noise.towards(self.counts, target).map_err(|(low, high)| {
                LandscapeError::Look { algorithm: Algorithm::Smooth, low, high, target }
            })?,
        };
        Ok(Arranged { sigma: Some(sigma), ..self.repaired(&cells, target) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn epsilon_is_found_for_a_density() {
        let composition = super::super::Composition::closest(2304, 9, 1.9, false).unwrap();
        let counts = composition.counts();
        let epsilon = automaton_epsilon(48, 48, counts, 0.862, 20, Seed(1));
        assert!((epsilon - 0.2).abs() < 0.03, "{epsilon}");
        assert_eq!(automaton_epsilon(48, 48, counts, 0.0, 2, Seed(1)), 0.0);
        assert_eq!(automaton_epsilon(48, 48, counts, 5.0, 2, Seed(1)), 1.0);
    }
}
