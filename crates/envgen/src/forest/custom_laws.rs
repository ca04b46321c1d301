//! Forests drawn from distributions of the caller.

use rand::distr::Distribution;

use super::blueprint::Forest;
use super::density::Density;
use super::error::ForestError;
use super::generate::plant;
use super::spec::{ForestSpec, RadiusLaw};
use crate::distribution::{Law, law};
use crate::generate::Spec;
use crate::seed::Seed;

/// Distributions that replace those of a [`ForestSpec`] in [`ForestSpec::generate_with_laws`].
///
/// For example, radii of trunks from a log-normal distribution, truncated to the limits of the spec:
///
/// ```
/// use envgen::distribution::Truncated;
/// use envgen::forest::{ForestLaws, ForestSpec};
/// use envgen::Seed;
/// use rand_distr::LogNormal;
///
/// let spec = ForestSpec { radius_min: 0.05, radius_max: 1.0, ..Default::default() };
/// let radii = LogNormal::from_mean_cv(0.25, 0.6)?;
/// let laws = ForestLaws::new().radii(Truncated::new(radii, spec.radius_min, spec.radius_max)?);
/// let forest = spec.generate_with_laws(Seed(1), &laws)?;
/// assert!(forest.edited());
/// assert!(forest.trees().iter().all(|tree| (0.05..=1.0).contains(&tree.radius)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
/// Foresters describe the diameters of trees by a Weibull distribution. A distribution that is not truncated gives
/// an error if a value exceeds the limits:
///
/// ```
/// # use envgen::forest::{ForestError, ForestLaws, ForestSpec};
/// # use envgen::Seed;
/// use rand_distr::{Distribution, Weibull};
///
/// let diameters = Weibull::new(0.4, 2.5)?;
/// let laws = ForestLaws::new().radii(diameters.map(|diameter: f64| 0.5 * diameter));
///
/// let wide = ForestSpec { radius_min: 1e-4, radius_max: 2.0, ..Default::default() };
/// let forest = wide.generate_with_laws(Seed(1), &laws)?;
/// assert!(forest.trees().len() > 50);
///
/// let narrow = ForestSpec { radius_min: 0.1, radius_max: 0.2, ..wide };
/// let error = narrow.generate_with_laws(Seed(1), &laws).unwrap_err();
/// assert!(matches!(error, ForestError::Radius { .. }), "{error}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct ForestLaws<'a> {
    radii: Option<Box<Law<'a>>>,
    density: Option<&'a (dyn Density + Sync)>,
}

impl<'a> ForestLaws<'a> {
    /// Creates a set without distributions, which keeps those of the spec.
    pub fn new() -> Self {
        ForestLaws::default()
    }

    /// Sets the distribution of the trees' radii in metres, which must lie from `radius_min` to `radius_max` of the
    /// spec. The spec's `radius`, `radius_law` and `radius_sigma` are then unused.
    pub fn radii(self, radii: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        ForestLaws { radii: Some(law(radii)), ..self }
    }

    /// Sets the density, as in [`ForestSpec::generate_with`].
    pub fn density(self, density: &'a (dyn Density + Sync)) -> Self {
        ForestLaws { density: Some(density), ..self }
    }
}

impl ForestSpec {
    /// Generates a forest from other distributions than the spec's. If `laws` is empty, the result is the forest of
    /// [`Spec::generate`]. Otherwise the provenance cannot contain the distributions and is therefore marked as
    /// edited. If the radii are replaced, the forest's spec has the radius law `uniform`, which has the same
    /// limits.
    ///
    /// # Errors
    /// As [`Spec::generate`], and when a distribution gives a value outside its limits: [`ForestError::Radius`] or
    /// [`ForestError::Density`].
    pub fn generate_with_laws(
        &self,
        seed: Seed,
        laws: &ForestLaws<'_>,
    ) -> Result<Forest, ForestError> {
        let mut spec = self.clone();
        if laws.radii.is_some() {
            spec.radius_law = RadiusLaw::Uniform;
        }
        if let Some(density) = laws.density {
            spec.intensity = density.max();
            spec.density = None;
        }
        spec.validate()?;
        let map = spec.density.as_ref().map(|map| map.over(spec.area(), spec.intensity));
        let density = match (laws.density, &map) {
            (Some(density), _) => Some(density as &dyn Density),
            (None, map) => map.as_ref().map(|map| map as &dyn Density),
        };
        let mut forest = plant(&spec, seed, density, laws.radii.as_deref())?;
        forest.edited = laws.radii.is_some() || laws.density.is_some();
        Ok(forest)
    }
}
