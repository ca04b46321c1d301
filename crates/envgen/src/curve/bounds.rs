//! The least rectangle around a path.

use std::f64::consts::FRAC_PI_2;

use super::{Curve, Path};
use crate::geometry::Rect;

impl Path<'_> {
    /// Returns the least rectangle around the path; `None` without pieces.
    ///
    /// ```
    /// use std::f64::consts::PI;
    ///
    /// use envgen::curve::{Curve, Path};
    /// use envgen::geometry::Pose;
    /// use envgen::glam::DVec2;
    ///
    /// // Half a circle to the left, with a radius of 5 m.
    /// let path = Path::new(vec![Curve::arc(Pose::new(0.0, 0.0, 0.0), 5.0 * PI, 0.2)]);
    /// let around = path.bounds().expect("a piece");
    /// assert!(around.max.distance(DVec2::new(5.0, 10.0)) < 1e-9);
    /// ```
    pub fn bounds(&self) -> Option<Rect> {
        let outermost = self.curves().iter().flat_map(|curve| {
            let between = along_an_axis(curve).map(|t| curve.pose_at(t).position);
            [curve.start.position, curve.end().position].into_iter().chain(between)
        });
        Rect::around(outermost)
    }
}

/// Returns the distances from a piece's start at which it runs along the x or the y axis. Only there, and at its ends,
/// can it be outermost.
fn along_an_axis(curve: &Curve) -> impl Iterator<Item = f64> {
    let turns_back = curve.start_curvature * curve.end_curvature < 0.0;
    let middle = if turns_back { -curve.start_curvature / curve.sharpness() } else { 0.0 };
    [(0.0, middle), (middle, curve.length)].into_iter().flat_map(move |(from, to)| {
        // The heading only rises or only falls in between.
        let [before, after] = [from, to].map(|t| curve.heading_at(t) / FRAC_PI_2);
        let first = before.min(after).ceil();
        let count = (before.max(after).floor() - first + 1.0).max(0.0) as u32;
        (0..count).filter_map(move |i| {
            let turn = (first + f64::from(i) - before) * FRAC_PI_2;
            let from_curvature = curve.curvature_at(from);
            let squared = from_curvature * from_curvature + 2.0 * curve.sharpness() * turn;
            let curvature = squared.max(0.0).sqrt().copysign(turn);
            // The turn is the distance times the mean curvature.
            let mean = 0.5 * (from_curvature + curvature);
            (turn != 0.0 && mean != 0.0).then(|| (from + turn / mean).clamp(from, to))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bounds_touch_the_path_on_every_side(
            x in -100.0..100.0_f64, heading in -9.0..9.0_f64, length in 0.1..100.0_f64,
            start_curvature in -0.3..0.3_f64, end_curvature in -0.3..0.3_f64, shape in 0..3,
        ) {
            let start = Pose::new(x, 2.0, heading);
            let end_curvature = if shape == 0 { start_curvature } else { end_curvature };
            let start_curvature = if shape == 1 { 0.0 } else { start_curvature };
            let path = Path::new(vec![Curve { start, length, start_curvature, end_curvature }]);
            let count = 20_000;
            let mut walk = path.walk();
            let points = (0..=count).map(|i| walk.to(length * f64::from(i) / f64::from(count)).0.position);
            let sampled = Rect::around(points).unwrap();
            let exact = path.bounds().unwrap();
            prop_assert!(exact.grown(1e-9).contains_rect(sampled), "{:?} {:?}", exact, sampled);
            // A chord of the samples deviates by at most k l^2 / 8.
            prop_assert!(sampled.grown(1e-6).contains_rect(exact), "{:?} {:?}", exact, sampled);
        }
    }

    #[test]
    fn lines_end_at_their_ends() {
        for heading in [0.0, FRAC_PI_2, -FRAC_PI_2, 1.0, 1e300] {
            let line = Curve::line(Pose::new(1.0, 2.0, heading), 3.0);
            let around = Rect::around([line.start.position, line.end().position]);
            assert_eq!(Path::new(vec![line]).bounds(), around);
        }
        assert_eq!(Path::new(Vec::new()).bounds(), None);
    }
}
