//! Smoothed noise, divided into classes by the counts, and repaired to a Total Edge.

use super::grid::{Arranged, Grid};
use crate::landscape::error::LandscapeError;
use crate::landscape::noise::Noise;
use crate::landscape::spec::Algorithm;

/// The default smoothing in cells, if nothing determines another value.
const SIGMA: f64 = 3.0;

/// Arranges a smoothed landscape, with or without a requested Total Edge.
pub(super) fn arrange(
    grid: &Grid<'_>,
    target: Option<u64>,
    sigma: Option<f64>,
) -> Result<Arranged, LandscapeError> {
    match target {
        None => Ok(fill(grid, sigma.unwrap_or(SIGMA))),
        Some(target) => towards(grid, target, sigma),
    }
}

fn fill(grid: &Grid<'_>, sigma: f64) -> Arranged {
    let noise = Noise::new(grid.rows, grid.cols, grid.seed);
    let cells = noise.landscape(grid.counts, sigma);
    Arranged { sigma: Some(sigma), ..Arranged::plain(cells) }
}

fn towards(grid: &Grid<'_>, target: u64, sigma: Option<f64>) -> Result<Arranged, LandscapeError> {
    let noise = Noise::new(grid.rows, grid.cols, grid.seed);
    let (sigma, cells) =
        match sigma {
            Some(sigma) => (sigma, noise.landscape(grid.counts, sigma)),
            None => noise.towards(grid.counts, target).map_err(|(low, high)| {
                LandscapeError::Look { algorithm: Algorithm::Smooth, low, high, target }
            })?,
        };
    Ok(Arranged { sigma: Some(sigma), ..grid.repaired(&cells, target) })
}
