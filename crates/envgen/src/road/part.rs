//! Segments of a road before they are placed.

use glam::DVec2;

use super::apportion::quantum;
use super::blueprint::SegmentKind;
use super::spec::RoadSpec;
use crate::curve::Curve;
use crate::geometry::Pose;

/// A segment before it is placed, with lengths and radii in metres.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) kind: SegmentKind,
    pub(super) length: f64,
    /// Length of each of the two clothoids of the segment.
    pub(super) ramp: f64,
    /// Radius; infinite for a straight.
    pub(super) radius: f64,
}

impl Part {
    pub(super) fn straight(length: f64) -> Part {
        Part { kind: SegmentKind::Straight, length, ramp: 0.0, radius: f64::INFINITY }
    }

    /// Returns the signed curvature at the tightest point, in 1/m.
    pub(super) fn curvature(&self) -> f64 {
        match self.kind {
            SegmentKind::Straight => 0.0,
            SegmentKind::Left => 1.0 / self.radius,
            SegmentKind::Right => -1.0 / self.radius,
        }
    }

    /// Returns the angle of the turn, positive to the left.
    pub(super) fn angle(&self) -> f64 {
        (self.length - self.ramp) * self.curvature()
    }

    /// Returns the curves of the segment, starting at a pose.
    pub(super) fn pieces(&self, start: Pose) -> impl Iterator<Item = Curve> {
        let k = self.curvature();
        let steps =
            [(self.ramp, 0.0, k), (self.length - 2.0 * self.ramp, k, k), (self.ramp, k, 0.0)];
        let mut pose = start;
        steps.into_iter().filter(|step| step.0 > 0.0).map(
            move |(length, start_curvature, end_curvature)| {
                let curve = Curve { start: pose, length, start_curvature, end_curvature };
                pose = curve.end();
                curve
            },
        )
    }

    /// Returns the displacement from the start to the end of the segment, for a given heading at the start.
    pub(super) fn displacement(&self, heading: f64) -> DVec2 {
        let start = Pose { position: DVec2::ZERO, heading };
        self.pieces(start).last().map_or(DVec2::ZERO, |curve| curve.end().position)
    }
}

/// Returns the length of each of the two clothoids of a turn, rounded so that sums of lengths remain exact.
pub(super) fn ramp(length: f64, spec: &RoadSpec) -> f64 {
    let quantum = quantum(spec.length);
    (spec.transition * length / quantum).floor() * quantum
}
