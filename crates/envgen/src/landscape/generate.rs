//! Generates a landscape from a spec and a seed.

use super::arrange::{Arranged, Grid, arrange};
use super::blueprint::Landscape;
use super::composition::Composition;
use super::edge::{edge_lower_bound, edge_upper_bound};
use super::error::LandscapeError;
use super::spec::{ClassOrder, LandscapeSpec};
use crate::error::SpecError;
use crate::seed::Seed;

pub(super) fn landscape(spec: &LandscapeSpec, seed: Seed) -> Result<Landscape, LandscapeError> {
    let composition = spec.composition()?;
    let mut counts = composition.counts().to_vec();
    if spec.order == ClassOrder::Shuffled {
        seed.stream("landscape/order", 0).shuffle(&mut counts);
    }
    let grid = Grid { rows: spec.rows as usize, cols: spec.cols as usize, counts: &counts, seed };
    let Arranged { cells, epsilon, sigma, swaps } = arrange(spec, &grid)?;
    Ok(Landscape::new(spec, seed, &composition, counts, cells, (epsilon, sigma, swaps)))
}

impl LandscapeSpec {
    /// Checks every setting, and the rules about several settings; returns the composition that they give.
    ///
    /// # Errors
    /// Names the first setting that is not allowed, its value and the allowed values.
    pub fn composition(&self) -> Result<Composition, SpecError> {
        self.check()?;
        let cells = self.rows * self.cols;
        let composition =
            Composition::closest(cells, self.classes, self.entropy, self.keep_classes)?;
        if let Some(target) = self.total_edge {
            let counts = composition.counts();
            let low = edge_lower_bound(self.rows, self.cols, counts);
            let high = edge_upper_bound(self.rows, self.cols, counts);
            if !(low..=high).contains(&target) {
                let allowed =
                    format!("from {low} to {high}, the bounds for these classes on this grid");
                return Err(SpecError::new("total_edge", target, allowed));
            }
        }
        Ok(composition)
    }
}
