//! Tree centres without a least distance: a Poisson count, then uniform positions.

use glam::DVec2;

use super::density::Density;
use super::error::ForestError;
use super::spec::ForestSpec;
use crate::distribution::poisson;
use crate::geometry::Rect;
use crate::seed::{Seed, Stream};

/// Draws X ~ Poisson(intensity x area) uniform points; with a density, those that remain after thinning.
pub(super) fn centres(
    spec: &ForestSpec,
    seed: Seed,
    density: Option<&dyn Density>,
) -> Result<Vec<DVec2>, ForestError> {
    let area = spec.centre_area();
    let count = draw_count(area, density.map_or(spec.intensity, Density::max), seed);
    let mut stream = seed.stream("forest/places", 0);
    let Some(density) = density else {
        return Ok((0..count).map(|_| uniform(area, &mut stream)).collect());
    };
    let mut centres = Vec::new();
    for _ in 0..count {
        let p = uniform(area, &mut stream);
        if stream.unit() * density.max() < checked(density, p)? {
            centres.push(p);
        }
    }
    Ok(centres)
}

/// Draws the number of trees, X ~ Poisson(intensity x area).
pub(super) fn draw_count(area: Rect, intensity: f64, seed: Seed) -> u64 {
    let size = area.size();
    poisson(&mut seed.stream("forest/count", 0), intensity * size.x * size.y)
}

pub(super) fn uniform(area: Rect, stream: &mut Stream) -> DVec2 {
    let x = stream.between(area.min.x, area.max.x);
    DVec2::new(x, stream.between(area.min.y, area.max.y))
}

/// Returns the density at a point, checked against its own limits.
pub(super) fn checked(density: &dyn Density, p: DVec2) -> Result<f64, ForestError> {
    let (value, max) = (density.at(p), density.max());
    if value >= 0.0 && value <= max {
        Ok(value)
    } else {
        Err(ForestError::Density { x: p.x, y: p.y, value, max })
    }
}
