//! Pieces of curves, one after the other.

use std::borrow::Cow;

use glam::DVec2;

use super::Curve;
use crate::geometry::{Pose, unit_vector};

/// A path of pieces, each starting where the one before ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Path<'a> {
    curves: Cow<'a, [Curve]>,
    /// Distance along the path at which each piece starts, and the path's length.
    starts: Vec<f64>,
}

impl<'a> Path<'a> {
    /// The path of the given pieces, which are taken as they are.
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

    /// The pieces.
    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// The distance along the path, in metres, at which piece `i` starts; for one past the last
    /// piece, the path's length.
    ///
    /// # Panics
    /// When there are fewer than `i` pieces.
    pub fn start_of(&self, i: usize) -> f64 {
        self.starts[i]
    }

    /// Length in metres.
    pub fn length(&self) -> f64 {
        self.starts[self.starts.len() - 1]
    }

    /// The pose at `s` metres along the path; before the start and after the end, the first or last
    /// piece's curve goes on. The default pose when there are no pieces. Costs the logarithm of the
    /// number of pieces; a [`Path::walk`] takes many poses in order faster.
    pub fn pose_at(&self, s: f64) -> Pose {
        self.piece_at(s).map_or_else(Pose::default, |(i, t)| self.curves[i].pose_at(t))
    }

    /// Curvature at `s` metres along the path in 1/m, positive to the left. Where two pieces meet it
    /// is the later one's.
    pub fn curvature_at(&self, s: f64) -> f64 {
        self.piece_at(s).map_or(0.0, |(i, t)| self.curves[i].curvature_at(t))
    }

    /// A walk along the path.
    pub fn walk(&self) -> Walk<'_> {
        Walk { path: self, piece: 0, axis: self.axis(0) }
    }

    /// Least and greatest heading along the path, in radians.
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

    /// The distance along the path, near `s` metres, at which a point lies beside it: the zero of
    /// the squared distance's derivative that Newton's method finds from `s`. Unlike
    /// [`PathIndex::locate`](super::PathIndex::locate) it is not misled where a path meets itself.
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

    /// The piece at `s` metres, and how far into it.
    pub(super) fn piece_at(&self, s: f64) -> Option<(usize, f64)> {
        let last = self.curves.len().checked_sub(1)?;
        let i = self.starts[1..=last].partition_point(|&start| start <= s);
        Some((i, s - self.starts[i]))
    }

    fn axis(&self, piece: usize) -> DVec2 {
        self.curves.get(piece).map_or(DVec2::X, |curve| unit_vector(curve.start.heading))
    }
}

/// Takes poses along a path in order of distance, at the cost of one sine and cosine each.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    path: &'a Path<'a>,
    piece: usize,
    axis: DVec2,
}

impl Walk<'_> {
    /// Pose and curvature at `s` metres along the path, which must not be less than at the call
    /// before: the walk goes on from the piece that it reached.
    #[inline]
    pub fn to(&mut self, s: f64) -> (Pose, f64) {
        let path = self.path;
        let before = self.piece;
        while self.piece + 1 < path.curves.len() && path.starts[self.piece + 1] <= s {
            self.piece += 1;
        }
        if self.piece != before {
            self.axis = path.axis(self.piece);
        }
        let Some(curve) = path.curves.get(self.piece) else { return (Pose::default(), 0.0) };
        let t = s - path.starts[self.piece];
        let position = curve.position_from(self.axis, t);
        (Pose { position, heading: curve.heading_at(t) }, curve.curvature_at(t))
    }
}
