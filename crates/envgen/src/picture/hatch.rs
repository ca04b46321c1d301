//! Hatched areas.

use glam::DVec2;

use super::path::PathData;
use super::style::Texture;
use super::view::View;
use crate::geometry::{Shape, edges, unit_vector};

/// Sine and cosine of 45 degrees.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The direction up to the right.
pub(super) const RISING: DVec2 = DVec2::new(HALF, -HALF);
/// The direction down to the right.
const FALLING: DVec2 = DVec2::new(HALF, HALF);

/// Hatching stops at this number of lines, so that pictures of very many overlapping areas remain small.
const MOST_LINES: usize = 100_000;

/// Returns the outline of any shape in px. Discs have 24 corners.
pub(super) fn outline(shape: &Shape, view: &View) -> Vec<DVec2> {
    match shape {
        Shape::Disc { center, radius } => (0..24)
            .map(|i| unit_vector(f64::from(i) * std::f64::consts::TAU / 24.0))
            .map(|direction| view.px(*center) + direction * *radius * view.scale)
            .collect(),
        _ => view.outline(shape),
    }
}

/// Returns the direction of the treads of stairs: along the shorter sides of an outline.
fn across(outline: &[DVec2]) -> DVec2 {
    let sides = [(0, 1), (1, 2)].map(|(i, j)| match (outline.get(i), outline.get(j)) {
        (Some(&a), Some(&b)) => b - a,
        _ => DVec2::X,
    });
    let shorter = if sides[0].length() < sides[1].length() { sides[0] } else { sides[1] };
    shorter.try_normalize().unwrap_or(DVec2::X)
}

/// Parallel lines inside outlines.
#[derive(Debug)]
pub(super) struct Hatch {
    pub(super) path: PathData,
    lines: usize,
}

impl Default for Hatch {
    fn default() -> Self {
        Hatch { path: PathData::new(1), lines: 0 }
    }
}

impl Hatch {
    /// Adds the lines of a texture.
    pub(super) fn texture(&mut self, texture: Texture, shape: &Shape, view: &View) {
        let outline = match texture {
            Texture::Plain => return,
            _ => outline(shape, view),
        };
        match texture {
            Texture::Plain => {}
            Texture::Dots => self.add(&outline, RISING, 8.0),
            Texture::Rising => self.add(&outline, RISING, 11.0),
            Texture::Falling => self.add(&outline, FALLING, 5.0),
            Texture::Crosses => {
                self.add(&outline, RISING, 7.0);
                self.add(&outline, FALLING, 7.0);
            }
            Texture::Waves => self.add(&outline, DVec2::X, 6.0),
            Texture::Treads => self.add(&outline, across(&outline), 6.0),
        }
    }

    /// Adds the lines of a direction (a unit vector) at multiples of `spacing` px from the picture's corner, so
    /// that the lines of neighbouring areas meet.
    pub(super) fn add(&mut self, outline: &[DVec2], direction: DVec2, spacing: f64) {
        let normal = direction.perp();
        let heights = outline.iter().map(|p| p.dot(normal));
        let (low, high) = heights
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        let (first, last) = ((low / spacing).ceil(), (high / spacing).floor());
        if !(last - first).is_finite() || last - first > 1e5 {
            return;
        }
        let mut crossings = Vec::new();
        for k in 0..=(last - first).max(-1.0) as i64 {
            let height = (first + k as f64) * spacing;
            crossings.clear();
            for (a, b) in edges(outline) {
                let (ha, hb) = (a.dot(normal), b.dot(normal));
                if (ha > height) != (hb > height) {
                    crossings.push((a + (b - a) * ((height - ha) / (hb - ha))).dot(direction));
                }
            }
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                if self.lines == MOST_LINES {
                    return;
                }
                self.lines += 1;
                let at = |along: f64| direction * along + normal * height;
                self.path.line(at(pair[0]), at(pair[1]));
            }
        }
    }
}
