//! The nearest point of a path.

use glam::DVec2;

use super::tree::BoxTree;
use super::{Curve, Path};
use crate::geometry::{Pose, Rect, unit_vector};

/// Pieces are cut where their heading has changed by this much, in radians, so that their boxes are
/// tight and the distance to them has few minima.
const LEAF_TURN: f64 = 0.4;

/// No piece is cut more often than this.
const MOST_LEAVES: f64 = 100_000.0;

/// Where a clothoid is probed for a minimum of the distance.
const PROBES: usize = 8;

/// Where a point lies relative to a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Distance along the path of the nearest point, in metres.
    pub s: f64,
    /// How far to the left of the path the point lies, in metres; negative to the right. Its
    /// absolute value is the distance to the path.
    pub offset: f64,
    /// The path's pose there.
    pub pose: Pose,
    /// The path's curvature there, in 1/m.
    pub curvature: f64,
}

/// An index over a path for nearest-point queries.
#[derive(Clone, Debug, PartialEq)]
pub struct PathIndex {
    leaves: Vec<Leaf>,
    tree: BoxTree,
}

/// A stretch of one piece, as a curve of its own, and where it starts along the path.
#[derive(Clone, Debug, PartialEq)]
struct Leaf {
    curve: Curve,
    s: f64,
    axis: DVec2,
}

impl PathIndex {
    /// Indexes a path; costs time and memory in proportion to its pieces and their turning.
    pub fn new(path: &Path<'_>) -> Self {
        let mut leaves = Vec::with_capacity(path.curves().len());
        for (i, curve) in path.curves().iter().enumerate() {
            let turn = curve.length * curve.tightest();
            let parts = (turn / LEAF_TURN).ceil().clamp(1.0, MOST_LEAVES);
            let length = curve.length / parts;
            for part in 0..parts as u32 {
                let t = f64::from(part) * length;
                let start = if part == 0 { curve.start } else { curve.pose_at(t) };
                let leaf = Curve {
                    start,
                    length,
                    start_curvature: curve.curvature_at(t),
                    end_curvature: curve.curvature_at(t + length),
                };
                let axis = unit_vector(start.heading);
                leaves.push(Leaf { curve: leaf, s: path.start_of(i) + t, axis });
            }
        }
        let boxes: Vec<Rect> = leaves.iter().map(Leaf::bounds).collect();
        PathIndex { leaves, tree: BoxTree::new(&boxes) }
    }

    /// The point of the path nearest to `p`; of several equally near ones the first. `None` when
    /// the path is empty or `p` is not finite. Costs about the logarithm of the number of pieces.
    pub fn locate(&self, p: DVec2) -> Option<Located> {
        if !p.is_finite() {
            return None;
        }
        let mut best: Option<(f64, f64, usize, f64)> = None;
        self.tree.nearest(p, |i| {
            let leaf = &self.leaves[i];
            let (t, distance) = leaf.nearest(p);
            let found = (distance, leaf.s + t, i, t);
            if best.is_none_or(|best| (found.0, found.1) < (best.0, best.1)) {
                best = Some(found);
            }
            best.map_or(f64::INFINITY, |best| best.0)
        });
        let (distance, s, i, t) = best?;
        let curve = &self.leaves[i].curve;
        let pose = curve.pose_at(t);
        let left = unit_vector(pose.heading).perp_dot(p - pose.position) >= 0.0;
        let offset = if left { distance } else { -distance };
        Some(Located { s, offset, pose, curvature: curve.curvature_at(t) })
    }
}

impl Leaf {
    fn bounds(&self) -> Rect {
        let (a, b) = (self.curve.start.position, self.at(self.curve.length));
        // The curve strays from its chord by no more than an arc of its greatest curvature.
        let sagitta = 0.125 * self.curve.length * self.curve.length * self.curve.tightest();
        Rect::new(a.min(b), a.max(b)).grown(sagitta * 1.1)
    }

    fn at(&self, t: f64) -> DVec2 {
        self.curve.position_from(self.axis, t)
    }

    /// The nearest point: how far along the leaf, and its distance.
    fn nearest(&self, p: DVec2) -> (f64, f64) {
        let length = self.curve.length;
        let mut best = (0.0, p.distance(self.curve.start.position));
        let mut offer = |t: f64| {
            let distance = p.distance(self.at(t));
            if distance < best.1 {
                best = (t, distance);
            }
        };
        if self.curve.is_arc() {
            let t = self.foot_on_arc(p);
            if t > 0.0 && t < length {
                offer(t);
            }
        } else {
            let mut before = (0.0, self.slope(p, 0.0));
            for k in 1..=PROBES {
                let t = length * k as f64 / PROBES as f64;
                let here = (t, self.slope(p, t));
                if before.1 < 0.0 && here.1 >= 0.0 {
                    offer(self.foot_between(p, before.0, here.0));
                }
                before = here;
            }
        }
        offer(length);
        best
    }

    /// Where the perpendicular from `p` meets the line or circle that the leaf is part of.
    fn foot_on_arc(&self, p: DVec2) -> f64 {
        let to = p - self.curve.start.position;
        let (x, y) = (self.axis.dot(to), self.axis.perp_dot(to));
        let k = self.curve.start_curvature;
        if k == 0.0 { x } else { libm::atan2(k * x, 1.0 - k * y) / k }
    }

    /// Half the derivative of the squared distance to `p`.
    fn slope(&self, p: DVec2, t: f64) -> f64 {
        (self.at(t) - p).dot(unit_vector(self.curve.heading_at(t)))
    }

    /// The zero of [`Leaf::slope`] between two distances where it changes sign: Newton's method,
    /// kept inside the bracket.
    fn foot_between(&self, p: DVec2, mut low: f64, mut high: f64) -> f64 {
        let mut t = 0.5 * (low + high);
        for _ in 0..60 {
            let direction = unit_vector(self.curve.heading_at(t));
            let from = self.at(t) - p;
            let slope = from.dot(direction);
            if slope < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let bend = 1.0 + self.curve.curvature_at(t) * direction.perp_dot(from);
            let mut next = t - slope / bend;
            if !(next > low && next < high) {
                next = 0.5 * (low + high);
            }
            if (next - t).abs() <= 1e-14 * (1.0 + self.curve.length) {
                return next;
            }
            t = next;
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn path(pieces: &[(f64, f64, f64)]) -> Path<'static> {
        let mut pose = Pose::new(3.0, -2.0, 0.4);
        let curves: Vec<Curve> = pieces
            .iter()
            .map(|&(length, start_curvature, end_curvature)| {
                let curve = Curve { start: pose, length, start_curvature, end_curvature };
                pose = curve.end();
                curve
            })
            .collect();
        Path::new(curves)
    }

    #[test]
    fn offsets_are_positive_to_the_left() {
        let index = PathIndex::new(&path(&[(10.0, 0.0, 0.0), (31.0, 0.1, 0.1)]));
        let start = Pose::new(3.0, -2.0, 0.4);
        let along = unit_vector(start.heading);
        let at = index.locate(start.position + along * 4.0 + along.perp() * 1.5).unwrap();
        assert!((at.s - 4.0).abs() < 1e-14 && (at.offset - 1.5).abs() < 1e-14);
        let at = index.locate(start.position + along * 4.0 - along.perp() * 2.0).unwrap();
        assert!((at.offset + 2.0).abs() < 1e-14);
        let at = index.locate(start.position - along * 7.0).unwrap();
        assert!(at.s == 0.0 && (at.offset.abs() - 7.0).abs() < 1e-14);
        // The arc's centre is equally near to all of it: the first point wins.
        let center = start.position + along * 10.0 + along.perp() * 10.0;
        assert!((index.locate(center).unwrap().offset - 10.0).abs() < 1e-12);
        assert_eq!(index.locate(DVec2::NAN), None);
        assert_eq!(PathIndex::new(&Path::new(Vec::new())).locate(DVec2::ZERO), None);
    }

    #[test]
    fn the_faintest_bend_keeps_its_digits() {
        let index = PathIndex::new(&path(&[(1e5, 1e-10, 1e-10)]));
        let at = index.locate(DVec2::new(3.0, -2.0) + unit_vector(0.4) * 777.0).unwrap();
        assert!((at.s - 777.0).abs() < 1e-9, "{at:?}");
    }

    proptest! {
        #[test]
        fn nothing_is_nearer_than_what_is_located(
            pieces in prop::collection::vec(
                (1.0..40.0_f64, -0.15..0.15_f64, -0.15..0.15_f64, 0..3_u8), 1..12,
            ),
            x in -150.0..150.0_f64,
            y in -150.0..150.0_f64,
        ) {
            let pieces: Vec<_> = pieces
                .into_iter()
                .map(|(length, a, b, kind)| match kind {
                    0 => (length, 0.0, 0.0),
                    1 => (length, a, a),
                    _ => (length, a, b),
                })
                .collect();
            let path = path(&pieces);
            let p = DVec2::new(x, y);
            let at = PathIndex::new(&path).locate(p).unwrap();
            prop_assert!((0.0..=path.length() + 1e-9).contains(&at.s));
            let there = path.pose_at(at.s).position;
            prop_assert!(there.distance(at.pose.position) < 1e-9);
            prop_assert!((there.distance(p) - at.offset.abs()).abs() < 1e-9);
            let steps = (path.length() / 0.05) as u32;
            let mut walk = path.walk();
            for i in 0..=steps {
                let (pose, _) = walk.to(f64::from(i) * 0.05);
                let distance = pose.position.distance(p);
                prop_assert!(distance >= at.offset.abs() - 1e-9, "{distance} < {at:?}");
            }
        }
    }
}
