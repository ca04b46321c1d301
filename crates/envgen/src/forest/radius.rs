//! The radii of trees.

use glam::DVec2;

use super::error::ForestError;
use super::spec::{ForestSpec, RadiusLaw};
use crate::distribution::{Law, standard_normal};
use crate::seed::{Seed, Stream};
use crate::world::Tree;

/// Gives every centre a radius from the spec's distribution or from another one.
pub(super) fn grow(
    spec: &ForestSpec,
    seed: Seed,
    centres: Vec<DVec2>,
    law: Option<&Law<'_>>,
) -> Result<Vec<Tree>, ForestError> {
    let mut stream = seed.stream("forest/radii", 0);
    let mut trees = Vec::with_capacity(centres.len());
    for center in centres {
        let radius = match law {
            None => draw(spec, &mut stream),
            Some(law) => checked(spec, law(&mut stream))?,
        };
        trees.push(spec.tree(center, radius));
    }
    Ok(trees)
}

/// Returns a radius, checked against the limits of the spec.
fn checked(spec: &ForestSpec, value: f64) -> Result<f64, ForestError> {
    let (min, max) = (spec.radius_min, spec.radius_max);
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(ForestError::Radius { value, min, max })
    }
}

pub(super) fn draw(spec: &ForestSpec, stream: &mut Stream) -> f64 {
    match spec.radius_law {
        RadiusLaw::Fixed => spec.radius,
        RadiusLaw::Uniform => stream.between(spec.radius_min, spec.radius_max),
        RadiusLaw::LogNormal => loop {
            let radius = spec.radius * libm::exp(spec.radius_sigma * standard_normal(stream));
            if (spec.radius_min..=spec.radius_max).contains(&radius) {
                return radius;
            }
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Spec;

    fn radii(spec: &ForestSpec) -> Vec<f64> {
        let mut stream = Seed(4).stream("test", 0);
        (0..20_000).map(|_| draw(spec, &mut stream)).collect()
    }

    #[test]
    fn laws_stay_in_their_limits_and_keep_their_middle() {
        let uniform = ForestSpec { radius_law: RadiusLaw::Uniform, ..Default::default() };
        let drawn = radii(&uniform);
        let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
        // Standard error 0.433 / sqrt(20,000) = 0.0031; five of them.
        assert!((mean - 1.25).abs() < 0.0155, "{mean}");
        assert!(drawn.iter().all(|r| (0.5..2.0).contains(r)));

        // Limits at e^(+-1.73 sigma) are symmetric in the logarithm, so the median stays.
        let log_normal = ForestSpec { radius_law: RadiusLaw::LogNormal, ..uniform };
        let mut drawn = radii(&log_normal);
        drawn.sort_by(f64::total_cmp);
        assert!(drawn[0] >= 0.5 && drawn[19_999] <= 2.0);
        assert!((drawn[10_000] - 1.0).abs() < 0.02, "{}", drawn[10_000]);
    }

    #[test]
    fn limits_that_cannot_be_kept_are_refused() {
        let law = RadiusLaw::LogNormal;
        let far =
            ForestSpec { radius_law: law, radius: 0.01, radius_sigma: 0.1, ..Default::default() };
        assert_eq!(far.validate().unwrap_err().field, "radius");
        let crossed = ForestSpec { radius_law: law, radius_min: 3.0, ..Default::default() };
        assert_eq!(crossed.validate().unwrap_err().field, "radius_min");
    }
}
