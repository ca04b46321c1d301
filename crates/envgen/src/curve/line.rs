//! Polylines along a path.

use glam::DVec2;

use super::{Curve, Path};
use crate::geometry::{unit_vector, wrap_angle};

/// The greatest angle, in radians, between two lines that count as one.
const STRAIGHT: f64 = 1e-12;

/// The greatest sudden change of heading, in radians, that counts as rounding; with a greater one the path has a
/// corner.
const CORNER: f64 = 1e-6;

/// One more than the cosine of the sharpest turn at which the lines beside a path are extended until they meet.
const SHARPEST: f64 = 0.2;

/// The greatest number of chords into which a piece is split.
const MOST_CHORDS: f64 = 100_000.0;

impl Path<'_> {
    /// Returns the distances along the path, in metres, at which it is split into chords such that lines up to
    /// `offset` metres beside it deviate from their chords by at most `tolerance` metres; start and end are
    /// included. Consecutive pieces on one straight line are one chord.
    ///
    /// # Panics
    /// When `tolerance` is not positive.
    #[track_caller]
    pub fn stations(&self, offset: f64, tolerance: f64) -> Vec<f64> {
        self.stations_between(0.0, self.length(), offset, tolerance)
    }

    /// Like [`Path::stations`], but for the section from `from` to `to` metres.
    ///
    /// # Panics
    /// As [`Path::stations`].
    #[track_caller]
    pub fn stations_between(&self, from: f64, to: f64, offset: f64, tolerance: f64) -> Vec<f64> {
        assert!(tolerance > 0.0, "the tolerance must be positive, got {tolerance} m");
        let mut stations = vec![from];
        let first = self.piece_at(from).map_or(0, |(i, _)| i);
        let mut before: Option<&Curve> = None;
        for (i, curve) in self.curves().iter().enumerate().skip(first) {
            let start = self.start_of(i).max(from);
            if start >= to {
                break;
            }
            let end = self.start_of(i + 1).min(to);
            let continues = |line: &Curve| {
                let turn = wrap_angle(curve.start.heading - line.start.heading);
                line.is_line() && curve.is_line() && turn.abs() < STRAIGHT
            };
            if i > first && start > from && !before.is_some_and(continues) {
                stations.push(start);
            }
            before = Some(curve);
            let chords = chords(curve, end - start, offset.abs(), tolerance);
            let length = (end - start) / chords;
            stations.extend((1..chords as u64).map(|k| start + k as f64 * length));
        }
        stations.push(to);
        stations
    }

    /// Returns the points at `offset` metres to the left of the path at given distances along it, which must not
    /// decrease. At a corner of the path, it returns the point where the lines beside the path meet.
    ///
    /// ```
    /// use envgen::curve::{Curve, Path};
    /// use envgen::geometry::Pose;
    /// use envgen::glam::DVec2;
    ///
    /// let path = Path::new(vec![Curve::line(Pose::new(0.0, 0.0, 0.0), 10.0)]);
    /// // The left edge of a road 6 m wide.
    /// let edge = path.offset_curve(3.0, &[0.0, 10.0]);
    /// assert_eq!(edge, [DVec2::new(0.0, 3.0), DVec2::new(10.0, 3.0)]);
    /// ```
    pub fn offset_curve(&self, offset: f64, stations: &[f64]) -> Vec<DVec2> {
        let mut walk = self.walk();
        stations
            .iter()
            .map(|&s| {
                let (pose, _) = walk.to(s);
                let beside = self.corner_at(s).unwrap_or_else(|| unit_vector(pose.heading).perp());
                pose.position + beside * offset
            })
            .collect()
    }

    /// Returns the result of [`corner`] for the point at `s` metres.
    fn corner_at(&self, s: f64) -> Option<DVec2> {
        let (piece, into) = self.piece_at(s)?;
        let before = self.curves().get(piece.checked_sub(1).filter(|_| into == 0.0)?)?;
        corner(before.end().heading, self.curves()[piece].start.heading)
    }
}

/// Returns the point where the lines beside a path meet, relative to the corner and per metre of their offset to
/// the left, if the heading changes at a point from `before` to `after`.
pub(crate) fn corner(before: f64, after: f64) -> Option<DVec2> {
    let [from, to] = [before, after].map(|heading| unit_vector(heading).perp());
    let is_turn = wrap_angle(after - before).abs() > CORNER;
    is_turn.then(|| (from + to) / (1.0 + from.dot(to)).max(SHARPEST))
}

/// Returns the number of chords into which a section of a piece is split. A chord over `l` metres of the centreline
/// deviates from a line at `offset` by k l^2 (1 + k offset) / 8 on the outer side, and by less on the inner side.
fn chords(curve: &Curve, length: f64, offset: f64, tolerance: f64) -> f64 {
    let k = curve.max_curvature();
    let longest = (8.0 * tolerance / (k * (1.0 + k * offset))).sqrt();
    (length / longest).ceil().clamp(1.0, MOST_CHORDS)
}
