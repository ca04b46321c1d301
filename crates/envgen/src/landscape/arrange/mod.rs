//! The algorithms that arrange the cells, one file each.

mod automaton;
mod bands;
mod grid;
mod mixed;
mod smooth;

pub use automaton::automaton_fill;
pub(super) use grid::{Arranged, Grid};

use super::error::LandscapeError;
use super::spec::{Algorithm, LandscapeSpec};

/// Arranges the cells of a grid by the algorithm of a spec.
pub(super) fn arrange(spec: &LandscapeSpec, grid: &Grid<'_>) -> Result<Arranged, LandscapeError> {
    let target = spec.total_edge;
    match spec.algorithm {
        Algorithm::Random | Algorithm::Mixed => {
            Ok(mixed::arrange(grid, target, spec.swaps_per_cell()))
        }
        Algorithm::Automaton => automaton::arrange(grid, target, spec.epsilon),
        Algorithm::Bands => Ok(bands::arrange(grid, target)),
        Algorithm::Smooth => smooth::arrange(grid, target, spec.sigma),
    }
}
