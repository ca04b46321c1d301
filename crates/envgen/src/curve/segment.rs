//! Segments of a path: lines, arcs and clothoids.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::series::displacement;
use crate::geometry::{Pose, unit_vector};

/// A segment of a path whose curvature changes linearly with the distance along it.
///
/// ```
/// use envgen::curve::Curve;
/// use envgen::geometry::Pose;
///
/// // A clothoid: straight ahead at first, and at its end 10 m later on a circle of radius 20 m.
/// let start = Pose::new(0.0, 0.0, 0.0);
/// let curve = Curve { start, length: 10.0, start_curvature: 0.0, end_curvature: 0.05 };
/// assert_eq!(curve.curvature_at(5.0), 0.025);
/// assert!((curve.turn() - 0.25).abs() < 1e-12);
/// // Positive curvature turns to the left.
/// assert!(curve.end().position.y > 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// The pose at the start.
    pub start: Pose,
    /// Length in metres.
    pub length: f64,
    /// Curvature at the start in 1/m, positive to the left.
    pub start_curvature: f64,
    /// Curvature at the end in 1/m.
    pub end_curvature: f64,
}

impl Curve {
    /// Creates a straight line.
    pub fn line(start: Pose, length: f64) -> Curve {
        Curve::arc(start, length, 0.0)
    }

    /// Creates an arc of constant curvature in 1/m, positive to the left.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::curve::Curve;
    /// use envgen::geometry::Pose;
    /// use envgen::glam::DVec2;
    ///
    /// // A quarter turn to the right with a radius of 2 m.
    /// let arc = Curve::arc(Pose::new(0.0, 0.0, 0.0), 2.0 * FRAC_PI_2, -0.5);
    /// assert!(arc.end().position.distance(DVec2::new(2.0, -2.0)) < 1e-12);
    /// assert!((arc.end().heading + FRAC_PI_2).abs() < 1e-12);
    /// ```
    pub fn arc(start: Pose, length: f64, curvature: f64) -> Curve {
        Curve { start, length, start_curvature: curvature, end_curvature: curvature }
    }

    /// Returns whether the segment is straight.
    pub fn is_line(&self) -> bool {
        self.start_curvature == 0.0 && self.end_curvature == 0.0
    }

    /// Returns whether the curvature is the same everywhere.
    pub fn is_arc(&self) -> bool {
        self.start_curvature == self.end_curvature
    }

    /// Returns the change of curvature per metre, in 1/m^2.
    pub fn sharpness(&self) -> f64 {
        if self.is_arc() { 0.0 } else { (self.end_curvature - self.start_curvature) / self.length }
    }

    /// Returns the greatest absolute curvature in 1/m.
    pub fn max_curvature(&self) -> f64 {
        self.start_curvature.abs().max(self.end_curvature.abs())
    }

    /// Returns the angle by which the heading changes from start to end, in radians.
    pub fn turn(&self) -> f64 {
        0.5 * self.length * (self.start_curvature + self.end_curvature)
    }

    /// Returns the curvature in 1/m at `t` metres from the start.
    pub fn curvature_at(&self, t: f64) -> f64 {
        self.start_curvature + self.sharpness() * t
    }

    /// Returns the heading in radians at `t` metres from the start. It is not wrapped: it can exceed pi.
    pub fn heading_at(&self, t: f64) -> f64 {
        self.start.heading + t * (self.start_curvature + 0.5 * self.sharpness() * t)
    }

    /// Returns the pose at `t` metres from the start. The error of the position is under 1e-14 of `t`, plus the
    /// rounding of the coordinates.
    pub fn pose_at(&self, t: f64) -> Pose {
        let axis = unit_vector(self.start.heading);
        Pose { position: self.position_from(axis, t), heading: self.heading_at(t) }
    }

    /// Returns the pose at the end.
    pub fn end(&self) -> Pose {
        let pose = self.pose_at(self.length);
        Pose { heading: self.start.heading + self.turn(), ..pose }
    }

    /// Returns the position at `t` metres, given the unit vector of the heading at the start.
    #[inline]
    pub(super) fn position_from(&self, axis: DVec2, t: f64) -> DVec2 {
        let local = displacement(self.start_curvature, self.sharpness(), t);
        self.start.position + axis * local.x + axis.perp() * local.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Gauss-Legendre of eight points on short stretches: a method of its own.
    fn integrated(curve: &Curve, t: f64) -> DVec2 {
        const NODES: [(f64, f64); 4] = [
            (0.183_434_642_495_649_8, 0.362_683_783_378_362),
            (0.525_532_409_916_329, 0.313_706_645_877_887_3),
            (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
            (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
        ];
        let parts = 64;
        let half = 0.5 * t / f64::from(parts);
        let mut sum = DVec2::ZERO;
        for part in 0..parts {
            let middle = (2.0 * f64::from(part) + 1.0) * half;
            for (x, weight) in NODES {
                for x in [-x, x] {
                    sum += unit_vector(curve.heading_at(middle + half * x)) * (weight * half);
                }
            }
        }
        curve.start.position + sum
    }

    #[test]
    fn a_quarter_circle_ends_where_it_should() {
        let curve = Curve::arc(Pose::new(1.0, 2.0, 0.0), 5.0 * std::f64::consts::PI, 0.1);
        let end = curve.end();
        assert!(end.position.distance(DVec2::new(11.0, 12.0)) < 1e-14);
        assert_eq!(end.heading, std::f64::consts::FRAC_PI_2);
    }

    #[test]
    fn a_clothoid_is_fresnels() {
        // C(1) and S(1), Abramowitz and Stegun table 7.7: heading pi t^2 / 2.
        let end_curvature = std::f64::consts::PI;
        let curve = Curve { length: 1.0, end_curvature, ..Curve::line(Pose::default(), 1.0) };
        let end = curve.end().position;
        assert!((end.x - 0.779_893_400_376_822_8).abs() < 1e-15, "{}", end.x);
        assert!((end.y - 0.438_259_147_390_354_8).abs() < 1e-15, "{}", end.y);
    }

    #[test]
    fn the_faintest_bend_is_nearly_a_line() {
        for curvature in [f64::MIN_POSITIVE, 1e-300, 1e-20, 1e-12] {
            let curve = Curve::arc(Pose::new(0.0, 0.0, 0.0), 1000.0, curvature);
            let p = curve.pose_at(1000.0).position;
            assert!((p.x - 1000.0).abs() < 1e-12 && (p.y - 5e5 * curvature).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn positions_agree_with_quadrature(
            heading in -7.0..7.0_f64,
            length in 0.1..500.0_f64,
            turn in -6.0..6.0_f64,
            other in -6.0..6.0_f64,
            arc: bool,
            at in 0.0..=1.0_f64,
        ) {
            let start_curvature = turn / length;
            let end_curvature = if arc { start_curvature } else { other / length };
            let start = Pose::new(-3.0, 8.0, heading);
            let curve = Curve { start, length, start_curvature, end_curvature };
            let t = at * length;
            let error = curve.pose_at(t).position.distance(integrated(&curve, t));
            prop_assert!(error < 1e-14 * length + 1e-13, "{error}");
        }
    }
}
