//! Generates a forest from a spec and a seed.

use super::blueprint::Forest;
use super::density::Density;
use super::error::ForestError;
use super::spec::ForestSpec;
use super::{hard_core, poisson, radius, start_goal};
use crate::distribution::Law;
use crate::generate::Spec;
use crate::seed::Seed;

/// Generates the forest of a valid spec. A density and a distribution of radii replace the spec's own if given.
pub(super) fn plant(
    spec: &ForestSpec,
    seed: Seed,
    density: Option<&dyn Density>,
    radii: Option<&Law<'_>>,
) -> Result<Forest, ForestError> {
    let centres = if spec.min_distance > 0.0 {
        hard_core::centres(spec, seed, density)?
    } else {
        poisson::centres(spec, seed, density)?
    };
    let trees = radius::grow(spec, seed, centres, radii)?;
    let (trees, cleared) = start_goal::clear(spec, trees);
    let spec = spec.clone();
    Ok(Forest { trees, cleared, spec, seed, edited: false, custom_radii: radii.is_some() })
}

impl ForestSpec {
    /// Generates a forest of varying density: `density` replaces `intensity` and the spec's own raster. The
    /// provenance cannot contain the density and is therefore marked as edited.
    ///
    /// ```
    /// use envgen::{Seed, forest::ForestSpec, glam::DVec2};
    ///
    /// // A forest that becomes denser to the east: its greatest density, and the density at a point.
    /// let density = (0.1, |p: DVec2| 0.1 * p.x / 50.0);
    /// let forest = ForestSpec::default().generate_with(Seed(7), &density)?;
    /// let east = forest.trees().iter().filter(|tree| tree.center.x > 25.0).count();
    /// assert!(2 * east > forest.trees().len());
    /// assert!(forest.edited());
    /// # Ok::<(), envgen::forest::ForestError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Spec::generate`], and when the density gives a value outside its own limits.
    pub fn generate_with(&self, seed: Seed, density: &dyn Density) -> Result<Forest, ForestError> {
        let peak = ForestSpec { intensity: density.max(), density: None, ..self.clone() };
        peak.validate()?;
        let mut forest = plant(&peak, seed, Some(density), None)?;
        forest.edited = true;
        Ok(forest)
    }
}
