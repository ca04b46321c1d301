//! The integral that gives the points of a clothoid.

use glam::DVec2;

use crate::geometry::unit_vector;

/// 1/n for n up to the greatest number of terms of the series.
const INVERSE: [f64; 66] = {
    let mut table = [0.0; 66];
    let mut n = 1;
    while n < table.len() {
        table[n] = 1.0 / n as f64;
        n += 1;
    }
    table
};

/// Sections whose heading may change by more than this, in radians, are split. The terms of the series then fall
/// quickly, and no term is so large that digits cancel.
const LONGEST: f64 = 1.5;

/// The greatest number of sections; [`World::check`](crate::World::check) refuses curves that need more.
const MOST_CUTS: f64 = 4096.0;

/// Returns the position after `t` metres from the origin along +x, on a curve of curvature `k` + `c` t.
#[inline]
pub(super) fn displacement(k: f64, c: f64, t: f64) -> DVec2 {
    if c != 0.0 {
        return clothoid(k, c, t);
    }
    let half = 0.5 * k * t;
    // Below this the arc is its chord to the last bit; division by a subnormal never happens.
    if half.abs() < 1e-9 {
        return DVec2::new(t, t * half);
    }
    let (sin, cos) = libm::sincos(half);
    let chord = 2.0 * sin / k;
    DVec2::new(chord * cos, chord * sin)
}

fn clothoid(k: f64, c: f64, t: f64) -> DVec2 {
    let bound = t.abs() * (k.abs() + 0.5 * (c * t).abs());
    if bound <= LONGEST {
        return t * series(k * t, c * t * t);
    }
    let cuts = (bound / LONGEST).ceil().clamp(1.0, MOST_CUTS);
    let part = t / cuts;
    let mut sum = DVec2::ZERO;
    for i in 0..cuts as u32 {
        let from = f64::from(i) * part;
        let axis = unit_vector(from * (k + 0.5 * c * from));
        let local = part * series((k + c * from) * part, c * part * part);
        sum += axis * local.x + axis.perp() * local.y;
    }
    sum
}

/// Returns the integral of exp(i (k v + q v^2 / 2)) over v from 0 to 1, by the power series of the integrand f:
/// from f' = i (k + q v) f follows (n + 1) b(n+1) = i (k b(n) + q b(n-1)).
fn series(k: f64, q: f64) -> DVec2 {
    let (mut last, mut term) = (DVec2::ZERO, DVec2::X);
    let mut sum = DVec2::X;
    for n in 1..INVERSE.len() - 1 {
        let next = (term * k + last * q).perp() * INVERSE[n];
        (last, term) = (term, next);
        sum += term * INVERSE[n + 1];
        if term.x.abs() + term.y.abs() + last.x.abs() + last.y.abs() < 1e-18 {
            break;
        }
    }
    sum
}

/// A short section of a clothoid as a polynomial of the distance from a point of it.
#[derive(Clone, Debug)]
pub(super) struct Polynomial<const N: usize> {
    start: DVec2,
    /// Taylor coefficients of the direction.
    direction: [DVec2; N],
}

impl<const N: usize> Polynomial<N> {
    /// Creates the polynomial around a point with its direction, its curvature `k` and the change of curvature per
    /// metre `c`: the direction f has f' = i (k + c u) f.
    pub(super) fn new(start: DVec2, axis: DVec2, k: f64, c: f64) -> Self {
        let mut direction = [axis; N];
        let mut last = DVec2::ZERO;
        for n in 1..N {
            let term = direction[n - 1];
            direction[n] = (term * k + last * c).perp() * INVERSE[n];
            last = term;
        }
        Polynomial { start, direction }
    }

    /// Returns the position at a signed distance `u` in metres. Its error is the distance times the angle turned to
    /// the power of N over N factorial.
    #[inline]
    pub(super) fn position(&self, u: f64) -> DVec2 {
        let sum =
            (0..N).rev().fold(DVec2::ZERO, |sum, n| sum * u + self.direction[n] * INVERSE[n + 1]);
        self.start + sum * u
    }

    /// Returns the unit vector of the heading at a signed distance `u` in metres.
    #[inline]
    pub(super) fn direction(&self, u: f64) -> DVec2 {
        self.direction.iter().rev().fold(DVec2::ZERO, |sum, c| sum * u + *c)
    }
}
