//! Paths: curves one after the other.

use std::borrow::Cow;

use glam::DVec2;

use super::Curve;
use super::series::Polynomial;
use crate::geometry::{Pose, unit_vector, wrap_angle};

/// A path of pieces, each of which starts where the one before it ends.
///
/// ```
/// use envgen::curve::{Curve, Path, PathIndex};
/// use envgen::geometry::Pose;
/// use envgen::glam::DVec2;
///
/// // 10 m straight on, then a quarter turn to the left with a radius of 4 m.
/// let line = Curve::line(Pose::new(0.0, 0.0, 0.0), 10.0);
/// let arc = Curve::arc(line.end(), 4.0 * std::f64::consts::FRAC_PI_2, 0.25);
/// let path = Path::new(vec![line, arc]);
/// assert!(path.pose_at(path.length()).position.distance(DVec2::new(14.0, 4.0)) < 1e-9);
/// // A point 1 m to the left of the path, 3 m from its start.
/// let near = PathIndex::new(&path).locate(DVec2::new(3.0, 1.0)).expect("a finite point");
/// assert!((near.s - 3.0).abs() < 1e-9 && (near.offset - 1.0).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Path<'a> {
    curves: Cow<'a, [Curve]>,
    /// Distance along the path at which each piece starts, and the path's length.
    starts: Vec<f64>,
}

impl<'a> Path<'a> {
    /// Creates the path of the given pieces, which are used as they are.
    pub fn new(curves: impl Into<Cow<'a, [Curve]>>) -> Self {
        let curves = curves.into();
        let mut starts = Vec::with_capacity(curves.len() + 1);
        let mut s = 0.0;
        starts.push(s);
        for curve in curves.iter() {
            s += curve.length;
            starts.push(s);
        }
        Path { curves, starts }
    }

    /// Returns the pieces.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Returns the distance along the path, in metres, at which piece `i` starts. For one past the last piece, it
    /// is the length of the path.
    ///
    /// # Panics
    /// When there are fewer than `i` pieces.
    pub fn start_of(&self, i: usize) -> f64 {
        self.starts[i]
    }

    /// Returns the length in metres.
    pub fn length(&self) -> f64 {
        self.starts[self.starts.len() - 1]
    }

    /// Returns the pose at `s` metres along the path. Before the start and after the end, the curve of the first or
    /// last piece continues. Without pieces, it is the default pose. It takes time logarithmic in the number of
    /// pieces; [`Path::walk`] computes many poses in order faster.
    pub fn pose_at(&self, s: f64) -> Pose {
        self.piece_at(s).map_or_else(Pose::default, |(i, t)| self.curves[i].pose_at(t))
    }

    /// Returns the curvature at `s` metres along the path in 1/m, positive to the left. Where two pieces meet, it
    /// is that of the later one.
    pub fn curvature_at(&self, s: f64) -> f64 {
        self.piece_at(s).map_or(0.0, |(i, t)| self.curves[i].curvature_at(t))
    }

    /// Returns the path with neighbouring lines, and neighbouring arcs of the same curvature, merged into one piece.
    pub fn merged(&self) -> Path<'static> {
        let mut merged: Vec<Curve> = Vec::with_capacity(self.curves.len());
        for curve in self.curves.iter() {
            match merged.last_mut() {
                Some(last)
                    if last.is_arc()
                        && curve.is_arc()
                        && last.start_curvature == curve.start_curvature
                        && wrap_angle(last.start.heading + last.turn() - curve.start.heading)
                            .abs()
                            < 1e-12 =>
                {
                    last.length += curve.length;
                }
                _ => merged.push(*curve),
            }
        }
        Path::new(merged)
    }

    /// Returns a walk along the path, which computes poses in order.
    pub fn walk(&self) -> Walk<'_> {
        Walk { path: self, piece: 0, axis: self.axis(0), patch: None }
    }

    /// Returns the least and greatest heading along the path, in radians.
    pub fn headings(&self) -> (f64, f64) {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |heading: f64| range = (range.0.min(heading), range.1.max(heading));
        for curve in self.curves.iter() {
            take(curve.start.heading);
            take(curve.start.heading + curve.turn());
            if curve.start_curvature * curve.end_curvature < 0.0 {
                take(curve.heading_at(-curve.start_curvature / curve.sharpness()));
            }
        }
        range
    }

    /// Returns the distance along the path, near `s` metres, at which a point lies beside it: the zero of the
    /// squared distance's derivative that Newton's method finds from `s`. Unlike
    /// [`PathIndex::locate`](super::PathIndex::locate), it does not jump to another section where a path meets
    /// itself.
    pub fn foot_from(&self, s: f64, point: DVec2) -> f64 {
        let mut s = s;
        for _ in 0..8 {
            let pose = self.pose_at(s);
            let step = unit_vector(pose.heading).dot(point - pose.position);
            s += step;
            if step.abs() <= 1e-15 * (1.0 + s.abs()) {
                break;
            }
        }
        s
    }

    /// Returns the index of the piece at `s` metres, and the distance into that piece.
    pub(super) fn piece_at(&self, s: f64) -> Option<(usize, f64)> {
        let last = self.curves.len().checked_sub(1)?;
        let i = self.starts[1..=last].partition_point(|&start| start <= s);
        Some((i, s - self.starts[i]))
    }

    fn axis(&self, piece: usize) -> DVec2 {
        self.curves.get(piece).map_or(DVec2::X, |curve| unit_vector(curve.start.heading))
    }
}

/// Computes poses along a path in order of distance, at the cost of about one sine and cosine each.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    path: &'a Path<'a>,
    piece: usize,
    axis: DVec2,
    patch: Option<Patch>,
}

impl Walk<'_> {
    /// Returns the pose and the curvature at `s` metres along the path. `s` must not be less than in the previous
    /// call, because the walk continues from the piece that it has reached. The result does not depend on earlier
    /// calls, and it agrees with [`Path::pose_at`] to the rounding of the coordinates.
    #[inline]
    pub fn to(&mut self, s: f64) -> (Pose, f64) {
        let path = self.path;
        let before = self.piece;
        while self.piece + 1 < path.curves.len() && path.starts[self.piece + 1] <= s {
            self.piece += 1;
        }
        if self.piece != before {
            self.axis = path.axis(self.piece);
            self.patch = None;
        }
        let Some(curve) = path.curves.get(self.piece) else { return (Pose::default(), 0.0) };
        let t = s - path.starts[self.piece];
        let inside = t >= 0.0 && t <= curve.length;
        let position = if curve.is_arc() || !inside {
            curve.position_from(self.axis, t)
        } else {
            match &self.patch {
                Some(patch) if patch.holds(t) => patch.position(t),
                _ => self.patch.insert(Patch::around(curve, self.axis, t)).position(t),
            }
        };
        (Pose { position, heading: curve.heading_at(t) }, curve.curvature_at(t))
    }
}

/// The number of coefficients of a patch: its half turn to this power, divided by the factorial, is under 1e-17.
const DEGREE: usize = 14;

/// Half of the greatest angle by which a patch turns, in radians.
const HALF_TURN: f64 = 0.3;

/// A section of a clothoid as a polynomial of the distance from its middle. The patches of a piece are fixed, and
/// their middles are computed from the piece's start, so that errors do not add up.
#[derive(Clone, Debug)]
struct Patch {
    /// Its index among the piece's patches, their number, and the length of each.
    number: f64,
    count: f64,
    length: f64,
    middle: f64,
    polynomial: Polynomial<DEGREE>,
}

impl Patch {
    fn around(curve: &Curve, axis: DVec2, t: f64) -> Patch {
        let count = (curve.length * curve.max_curvature() / (2.0 * HALF_TURN)).ceil().max(1.0);
        let length = curve.length / count;
        let number = (t / length).floor().min(count - 1.0);
        let middle = (number + 0.5) * length;
        let start = curve.position_from(axis, middle);
        let axis = unit_vector(curve.heading_at(middle));
        let (k, c) = (curve.curvature_at(middle), curve.sharpness());
        Patch { number, count, length, middle, polynomial: Polynomial::new(start, axis, k, c) }
    }

    #[inline]
    fn holds(&self, t: f64) -> bool {
        (t / self.length).floor().min(self.count - 1.0) == self.number
    }

    #[inline]
    fn position(&self, t: f64) -> DVec2 {
        self.polynomial.position(t - self.middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> Path<'static> {
        let straight = Curve::line(Pose::new(1.0, 1.0, 0.0), 10.0);
        let clothoid = Curve { end_curvature: 0.05, ..Curve::line(straight.end(), 8.0) };
        let arc = Curve::arc(clothoid.end(), 30.0, 0.05);
        Path::new(vec![straight, clothoid, arc])
    }

    #[test]
    fn walking_is_jumping() {
        let path = path();
        assert_eq!(path.length(), 48.0);
        let mut walk = path.walk();
        for i in 0..=480 {
            let s = f64::from(i) * 0.1;
            let (pose, curvature) = walk.to(s);
            let direct = path.pose_at(s);
            assert!(pose.position.distance(direct.position) < 1e-14 * 64.0);
            assert_eq!((pose.heading, curvature), (direct.heading, path.curvature_at(s)));
            assert!((path.foot_from(s + 0.3, pose.position) - s).abs() < 1e-12);
        }
        assert_eq!(path.curvature_at(10.0), 0.0);
        assert_eq!(path.curvature_at(18.0), 0.05);
    }

    #[test]
    fn merging_keeps_the_curve() {
        let line = Curve::line(Pose::default(), 4.0);
        let further = Curve::line(line.end(), 5.0);
        let arc = Curve::arc(further.end(), 6.0, 0.1);
        let path = Path::new(vec![line, further, arc, Curve::arc(arc.end(), 2.0, 0.1)]);
        let merged = path.merged();
        assert_eq!(
            merged.curves(),
            [Curve::line(Pose::default(), 9.0), Curve::arc(further.end(), 8.0, 0.1)]
        );
        assert_eq!(path.stations(0.0, 1e3), [0.0, 9.0, 15.0, 17.0]);
        // Lines that turn are none.
        let turned = Curve::line(Pose { heading: 0.3, ..line.end() }, 5.0);
        assert_eq!(Path::new(vec![line, turned]).stations(0.0, 1e3), [0.0, 4.0, 9.0]);
        let right = Curve::line(Pose { heading: std::f64::consts::FRAC_PI_2, ..line.end() }, 5.0);
        let edge = Path::new(vec![line, right]).offset_curve(1.0, &[0.0, 4.0, 9.0]);
        let expected = [DVec2::new(0.0, 1.0), DVec2::new(3.0, 1.0), DVec2::new(3.0, 5.0)];
        assert!(edge.iter().zip(expected).all(|(a, b)| a.distance(b) < 1e-12), "{edge:?}");
    }

    #[test]
    fn chords_stay_within_the_tolerance() {
        let path = path();
        for (offset, tolerance) in [(0.0, 0.01), (4.0, 0.01), (-4.0, 1e-4), (4.0, 0.3)] {
            let stations = path.stations(offset, tolerance);
            let line = path.offset_curve(offset, &stations);
            for (pair, s) in line.windows(2).zip(stations.windows(2)) {
                for i in 0..=10 {
                    let p =
                        path.offset_curve(offset, &[s[0] + (s[1] - s[0]) * f64::from(i) / 10.0])[0];
                    let stray = crate::geometry::distance_to_segment(p, pair[0], pair[1]);
                    assert!(stray <= tolerance * (1.0 + 1e-9), "{stray}");
                }
            }
        }
        assert!(path.stations(4.0, 0.01).len() < 40);
    }
}
