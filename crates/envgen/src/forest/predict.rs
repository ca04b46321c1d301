//! Predictions of theory for a Poisson forest in its own area, border included.
//!
//! A disc around a point contains a Poisson number of centres. Its mean is the intensity times the area of the part
//! of the disc that lies **inside the area of the centres**. Every prediction is the average of a function of that
//! mean over the points of an area. The function is constant in the interior of the area, and less near the border,
//! where part of the disc lies outside. On a torus all points are alike, and a disc that extends around the torus
//! is cut off at half a side from its centre.

use std::f64::consts::PI;

use glam::DVec2;

use super::spec::{Border, ForestSpec, RadiusLaw};

/// Nodes and weights of Gauss-Legendre quadrature on [-1, 1], the positive half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Number of panels of eight nodes for distances to neighbours, between those to sides of the area. Beyond the distance
/// at which an end of the area is felt, there is one.
const DISTANCE_PANELS: usize = 2;

/// Number of panels of eight nodes for radii.
const RADIUS_PANELS: usize = 2;

/// A disc with this mean number of centres is assumed to contain at least one.
const CERTAIN: f64 = 36.0;

/// If a disc has this mean number of centres, the border beyond it hardly matters.
const FAR: f64 = 14.0;

/// This number of standard deviations covers practically all of a log-normal distribution.
const ALL_OF_NORMAL: f64 = 8.0;

/// Returns the share of the area under trunks.
pub(super) fn cover(spec: &ForestSpec) -> f64 {
    let centres = Centres::of(spec);
    let radii = radii(spec);
    let uncovered = |p: DVec2| {
        let area: f64 = radii.iter().map(|&(r, weight)| weight * centres.inside(p, r)).sum();
        libm::exp(-spec.intensity * area)
    };
    1.0 - centres.mean(0.5 * spec.area().size(), spec.largest_radius(), uncovered)
}

/// Returns the share of the trees that touch no other tree, in a forest with trees that all have the same radius.
pub(super) fn untouched(spec: &ForestSpec) -> f64 {
    let centres = Centres::of(spec);
    let mean = spec.intensity * centres.area();
    let reach = 2.0 * spec.radius;
    // Of n trees, n - 1 must lie elsewhere; n is Poisson, but not 0.
    let alone = |p: DVec2| {
        let elsewhere = mean - spec.intensity * centres.inside(p, reach);
        mean * others_elsewhere(mean, elsewhere, 0) / -libm::expm1(-mean)
    };
    centres.mean(centres.half, reach, alone)
}

/// Returns the mean distance in metres from a tree to the nearest other tree, in a forest of at least two trees.
pub(super) fn nearest_neighbour(spec: &ForestSpec) -> f64 {
    let centres = Centres::of(spec);
    let mean = spec.intensity * centres.area();
    let two_or_more = if mean < 1e-2 {
        mean * mean * (0.5 - mean / 3.0 + mean * mean / 8.0)
    } else {
        -libm::expm1(-mean) - mean * libm::exp(-mean)
    };
    // A corner has fewest neighbours.
    let corner = if centres.torus { DVec2::ZERO } else { centres.half };
    let diagonal = 2.0 * centres.half.length();
    let mut farthest = (CERTAIN / (PI * spec.intensity)).sqrt();
    while farthest < diagonal && spec.intensity * centres.inside(corner, farthest) < CERTAIN {
        farthest *= 1.25;
    }
    let farthest = farthest.min(diagonal);
    // How far an end of the area is felt. A narrow one has few trees in a disc.
    let mut reach = (FAR / (PI * spec.intensity)).sqrt();
    while reach < diagonal && spec.intensity * centres.inside(DVec2::ZERO, reach) < FAR {
        reach *= 1.25;
    }
    let distance = |p: DVec2| {
        let density = |t| {
            let elsewhere = mean - spec.intensity * centres.inside(p, t);
            mean * others_elsewhere(mean, elsewhere, 1) / two_or_more
        };
        // The area of a disc within the rectangle has a bend where the disc meets a side. It does not matter where the
        // nearest tree is hardly ever so far.
        let (high, low) = (centres.half - p, centres.half + p);
        let is_felt = |t: &f64| *t > 0.0 && spec.intensity * centres.inside(p, *t) < FAR;
        let sides = [high.x, low.x, high.y, low.y].into_iter().filter(is_felt);
        let mut ends: Vec<f64> = sides.chain([reach.min(farthest)]).collect();
        ends.sort_by(f64::total_cmp);
        let (mut from, mut sum) = (0.0, 0.0);
        for to in ends {
            sum += integral(from, to, DISTANCE_PANELS, density);
            from = to;
        }
        sum + integral(from, farthest.max(from), 1, density)
    };
    centres.mean(centres.half, reach, distance)
}

/// Returns the sum, over n > `least`, of the Poisson probability of n over `mean`, times the probability that n - 1
/// of them lie in a part that has `elsewhere` of the mean; for `least` 0 and 1.
fn others_elsewhere(mean: f64, elsewhere: f64, least: u32) -> f64 {
    // exp(-mean) (exp(e) - 1) / e, less exp(-mean) for the case of a single one.
    let e = elsewhere.max(0.0);
    let none = libm::exp(-mean);
    match least {
        0 if e < 1e-9 => none,
        0 => (libm::exp(e - mean) - none) / e,
        _ if e < 1e-2 => none * e * (0.5 + e * (1.0 / 6.0 + e / 24.0)),
        _ => (libm::exp(e - mean) - none * (1.0 + e)) / e,
    }
}

/// Returns radii of the distribution, with their probabilities.
fn radii(spec: &ForestSpec) -> Vec<(f64, f64)> {
    let (least, greatest) = (spec.radius_min, spec.radius_max);
    let mut radii = Vec::new();
    match spec.radius_law {
        _ if spec.radius_law == RadiusLaw::Fixed || least == greatest => {
            return vec![(spec.largest_radius(), 1.0)];
        }
        RadiusLaw::Fixed | RadiusLaw::Uniform => {
            nodes(least, greatest, RADIUS_PANELS, |r, weight| radii.push((r, weight)));
        }
        RadiusLaw::LogNormal => {
            let z = |r: f64| libm::log(r / spec.radius) / spec.radius_sigma;
            let (low, high) = (z(least).max(-ALL_OF_NORMAL), z(greatest).min(ALL_OF_NORMAL));
            nodes(low, high, RADIUS_PANELS, |z, weight| {
                let r = spec.radius * libm::exp(spec.radius_sigma * z);
                radii.push((r, weight * libm::exp(-0.5 * z * z)));
            });
        }
    }
    let sum: f64 = radii.iter().map(|(_, weight)| weight).sum();
    radii.iter_mut().for_each(|(_, weight)| *weight /= sum);
    radii
}

/// The rectangle in which the centres of trees lie; its centre is the origin.
struct Centres {
    /// Half width and half height in metres.
    half: DVec2,
    torus: bool,
}

impl Centres {
    fn of(spec: &ForestSpec) -> Self {
        let torus = spec.border == Border::Torus;
        Centres { half: 0.5 * spec.centre_area().size(), torus }
    }

    fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// Returns the area of the part of a disc around a point that lies in the rectangle.
    fn inside(&self, p: DVec2, radius: f64) -> f64 {
        let (high, low) = (self.half - p, self.half + p);
        if high.min(low).min_element() >= radius {
            return PI * radius * radius;
        }
        // By inclusion and exclusion of what lies beyond the sides, and beyond two at a corner.
        let side = |distance: f64| beyond(distance, radius);
        let [east, west, north, south] = [high.x, low.x, high.y, low.y].map(side);
        let corner = |x: f64, y: f64, beyond_x: f64, beyond_y: f64| {
            beyond_corner(x, y, beyond_x, beyond_y, radius)
        };
        let corners = corner(high.x, high.y, east, north)
            + corner(high.x, low.y, east, south)
            + corner(low.x, high.y, west, north)
            + corner(low.x, low.y, west, south);
        (PI * radius * radius - east - west - north - south + corners).max(0.0)
    }

    /// Returns the mean of a function that depends on a disc of radius `reach`, over the points of a rectangle of
    /// this half width and half height around the origin.
    fn mean(&self, half: DVec2, reach: f64, f: impl Fn(DVec2) -> f64) -> f64 {
        if self.torus {
            return f(DVec2::ZERO);
        }
        // One quarter represents all, by symmetry.
        let x = self.axis(half.x, self.half.x, reach);
        let y = self.axis(half.y, self.half.y, reach);
        let row = |&(y, weight): &(f64, f64)| {
            weight * x.iter().map(|&(x, weight)| weight * f(DVec2::new(x, y))).sum::<f64>()
        };
        y.iter().map(row).sum()
    }

    /// Returns nodes from the middle of an axis to its end: one for the whole interior, eight for the border, and
    /// eight beyond the border of the centres.
    fn axis(&self, end: f64, border: f64, reach: f64) -> Vec<(f64, f64)> {
        let interior = (border - reach).clamp(0.0, end);
        let border = border.clamp(interior, end);
        let mut axis = Vec::with_capacity(17);
        if interior > 0.0 {
            axis.push((0.0, interior / end));
        }
        for (from, to) in [(interior, border), (border, end)] {
            if to > from {
                nodes(from, to, 1, |x, weight| axis.push((x, weight * (to - from) / end)));
            }
        }
        axis
    }
}

/// Returns the area of a disc around the origin beyond a line at a distance, which may be negative.
fn beyond(distance: f64, radius: f64) -> f64 {
    if distance >= radius {
        return 0.0;
    }
    if distance <= -radius {
        return PI * radius * radius;
    }
    let half_chord = (radius * radius - distance * distance).sqrt();
    radius * radius * libm::acos(distance / radius) - distance * half_chord
}

/// Returns the area of a disc around the origin beyond two lines at right angles, given the areas beyond each of
/// them.
fn beyond_corner(x: f64, y: f64, beyond_x: f64, beyond_y: f64, radius: f64) -> f64 {
    if x * x + y * y >= radius * radius {
        // The corner lies outside of the disc.
        return match (x >= 0.0, y >= 0.0) {
            (true, true) => 0.0,
            (true, false) => beyond_x,
            (false, true) => beyond_y,
            (false, false) => beyond_x + beyond_y - PI * radius * radius,
        }
        .max(0.0);
    }
    0.5 * (beyond_x + beyond_y) - 0.25 * PI * radius * radius + x * y
}

/// Visits the nodes of a composite quadrature between two numbers. The weights add up to 1.
fn nodes(from: f64, to: f64, panels: usize, mut node: impl FnMut(f64, f64)) {
    let half = 0.5 * (to - from) / panels as f64;
    for panel in 0..panels {
        let middle = from + (2 * panel + 1) as f64 * half;
        for (x, weight) in GAUSS {
            for x in [-x, x] {
                node(middle + x * half, 0.5 * weight / panels as f64);
            }
        }
    }
}

fn integral(from: f64, to: f64, panels: usize, f: impl Fn(f64) -> f64) -> f64 {
    let mut sum = 0.0;
    nodes(from, to, panels, |x, weight| sum += weight * f(x));
    sum * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_narrow_forests_are_as_far_as_in_simulations() {
        let narrow = |width, height, intensity, border| ForestSpec {
            width,
            height,
            intensity,
            border,
            radius: 0.2,
            ..ForestSpec::default()
        };
        // By the integral in steps of a millimetre.
        let spec = narrow(5.0, 50.0, 0.1, Border::Torus);
        let (centres, mean) = (Centres::of(&spec), 25.0);
        let steps = (0..30_000).map(|i| (i as f64 + 0.5) / 1000.0);
        let sum: f64 = steps
            .map(|t| others_elsewhere(mean, mean - 0.1 * centres.inside(DVec2::ZERO, t), 1))
            .sum();
        let expected = mean * sum / 1000.0 / (1.0 - 26.0 * libm::exp(-mean));
        let found = nearest_neighbour(&spec);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found}, {expected}");
        // The mean of 4000 simulated forests, with a standard error of 0.05.
        let found = nearest_neighbour(&narrow(5000.0, 20.0, 0.001, ForestSpec::default().border));
        assert!((found - 27.60).abs() < 0.1, "{found}");
    }
}
