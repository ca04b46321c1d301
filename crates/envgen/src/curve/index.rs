//! Nearest-point queries on paths.

use glam::DVec2;

use super::series::Polynomial;
use super::tree::BoxTree;
use super::{Curve, Path};
use crate::geometry::{Pose, Rect, distance_to_segment, unit_vector};

/// Pieces are split where their heading has changed by this angle, in radians, so that their boxes are tight and
/// for most of them the chord is enough.
const LEAF_TURN: f64 = 0.2;

/// Straight pieces are split, too, into lengths of the average piece divided by this, so that the box of an oblique
/// one is not mostly empty.
const CUTS: f64 = 2.0;

/// The number of coefficients of a leaf: its turn to this power, divided by the factorial, is under 1e-16.
const DEGREE: usize = 14;

/// The greatest number of leaves of a piece. A piece that turns by over 20,000 rad is therefore located only
/// roughly; the pieces of a world turn by 1,000 rad at most.
const MOST_LEAVES: f64 = 100_000.0;

/// The number of leaves that are kept and then examined together.
const KEPT: usize = 16;

/// The number of points at which a clothoid is probed for minima of the distance, if there may be several.
const PROBES: usize = 8;

/// The position of a point relative to a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Distance along the path of the nearest point on it, in metres.
    pub s: f64,
    /// Distance in metres by which the point lies to the left of the path, negative if it lies to the right. Its
    /// absolute value is the distance to the path.
    pub offset: f64,
    /// Pose of the path at the nearest point.
    pub pose: Pose,
    /// Curvature of the path at the nearest point, in 1/m.
    pub curvature: f64,
}

/// An index over a path for nearest-point queries.
#[derive(Clone, Debug, PartialEq)]
pub struct PathIndex {
    leaves: Vec<Leaf>,
    tree: BoxTree,
}

/// A section of one piece, as a curve of its own.
#[derive(Clone, Debug, PartialEq)]
struct Leaf {
    curve: Curve,
    /// Distance along the path at which the leaf starts.
    s: f64,
    /// Unit vector of the heading at the start of the leaf.
    axis: DVec2,
    end: DVec2,
    end_axis: DVec2,
    /// Greatest distance of the leaf from its chord, in metres.
    sagitta: f64,
}

impl PathIndex {
    /// Indexes a path. Time and memory are proportional to the number of its pieces and to their turning.
    pub fn new(path: &Path<'_>) -> Self {
        let count = path.curves().len();
        let longest = path.length() / (CUTS * count as f64);
        let mut leaves = Vec::with_capacity(2 * count);
        for (i, curve) in path.curves().iter().enumerate() {
            let by_turn = (curve.length * curve.max_curvature() / LEAF_TURN).ceil();
            let parts = by_turn.max((curve.length / longest).ceil()).clamp(1.0, MOST_LEAVES);
            let length = curve.length / parts;
            let mut start = curve.start;
            let mut axis = unit_vector(start.heading);
            for part in 0..parts as u32 {
                let t = f64::from(part) * length;
                let end = curve.pose_at(t + length);
                let end_axis = unit_vector(end.heading);
                let leaf = Curve {
                    start,
                    length,
                    start_curvature: curve.curvature_at(t),
                    end_curvature: curve.curvature_at(t + length),
                };
                // An arc of the greatest curvature strays farthest from its chord; a small margin
                // covers the rounding of the start.
                let sagitta = 0.126 * length * length * leaf.max_curvature()
                    + 1e-12 * (1.0 + start.position.abs().max_element());
                let s = path.start_of(i) + t;
                leaves.push(Leaf { curve: leaf, s, axis, end: end.position, end_axis, sagitta });
                (start, axis) = (end, end_axis);
            }
        }
        // A path may return to an earlier position: neighbours in space become neighbours in the tree.
        let middles: Vec<DVec2> = leaves.iter().map(|leaf| leaf.bounds().center()).collect();
        let mut order: Vec<usize> = (0..leaves.len()).collect();
        arrange(&mut order, leaves.len().next_power_of_two(), &middles);
        let leaves: Vec<Leaf> = order.into_iter().map(|i| leaves[i].clone()).collect();
        let boxes: Vec<Rect> = leaves.iter().map(Leaf::bounds).collect();
        PathIndex { leaves, tree: BoxTree::new(&boxes) }
    }

    /// Returns the point of the path that is nearest to `p`; of several equally near points, the first. `None` if
    /// the path is empty or `p` is not finite. It takes time about logarithmic in the number of pieces.
    pub fn locate(&self, p: DVec2) -> Option<Located> {
        if !p.is_finite() {
            return None;
        }
        let mut best = Nearest { squared: f64::INFINITY, s: f64::INFINITY, leaf: 0, t: 0.0 };
        // A leaf's chord bounds its distance from both sides. Leaves that may be the nearest are kept, and
        // examined exactly when all bounds are known.
        let mut bound = f64::INFINITY;
        let mut kept = [(0.0, 0); KEPT];
        let mut count = 0;
        self.tree.nearest(p, |i| {
            let leaf = &self.leaves[i];
            let chord = distance_to_segment(p, leaf.curve.start.position, leaf.end);
            let (least, most) = ((chord - leaf.sagitta).max(0.0), chord + leaf.sagitta);
            bound = bound.min(most * most);
            if least * least <= bound {
                if count == KEPT {
                    self.look(&kept, p, bound, &mut best);
                    count = 0;
                }
                kept[count] = (least * least, i);
                count += 1;
            }
            bound
        });
        self.look(&kept[..count], p, bound, &mut best);
        if best.squared == f64::INFINITY {
            return None;
        }
        let leaf = &self.leaves[best.leaf];
        let curve = &leaf.curve;
        let pose = Pose { position: leaf.at(best.t), heading: curve.heading_at(best.t) };
        let left = unit_vector(pose.heading).perp_dot(p - pose.position) >= 0.0;
        let distance = pose.position.distance(p);
        let offset = if left { distance } else { -distance };
        Some(Located { s: best.s, offset, pose, curvature: curve.curvature_at(best.t) })
    }

    /// Examines the leaves that may be as near as the bound.
    fn look(&self, kept: &[(f64, usize)], p: DVec2, bound: f64, best: &mut Nearest) {
        for &(least, i) in kept.iter().filter(|(least, _)| *least <= bound) {
            if least <= best.squared {
                self.leaves[i].offer(i, p, best);
            }
        }
    }
}

/// Orders the leaves below a node of a tree so that its two halves lie apart, along the longer side of the
/// rectangle that the leaves span.
fn arrange(order: &mut [usize], room: usize, middles: &[DVec2]) {
    let Some(span) = Rect::around(order.iter().map(|&i| middles[i])) else { return };
    if order.len() < 2 {
        return;
    }
    let wide = span.size().x >= span.size().y;
    let key = |i: usize| if wide { middles[i].x } else { middles[i].y };
    order.sort_unstable_by(|&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
    let half = room / 2;
    let (first, second) = order.split_at_mut(half.min(order.len()));
    arrange(first, half, middles);
    arrange(second, half, middles);
}

/// The nearest point so far.
struct Nearest {
    squared: f64,
    s: f64,
    leaf: usize,
    t: f64,
}

impl Leaf {
    fn bounds(&self) -> Rect {
        let (a, b) = (self.curve.start.position, self.end);
        Rect::new(a.min(b), a.max(b)).grown(self.sagitta)
    }

    fn at(&self, t: f64) -> DVec2 {
        self.curve.position_from(self.axis, t)
    }

    /// Updates the nearest point with the leaf's points.
    fn offer(&self, leaf: usize, p: DVec2, best: &mut Nearest) {
        let start = self.curve.start.position;
        let mut take = |t: f64, at: DVec2| {
            let (squared, s) = (at.distance_squared(p), self.s + t);
            if (squared, s) < (best.squared, best.s) {
                *best = Nearest { squared, s, leaf, t };
            }
        };
        let length = self.curve.length;
        take(0.0, start);
        take(length, self.end);
        if self.curve.is_arc() {
            let t = self.foot_on_arc(p);
            if t > 0.0 && t < length {
                take(t, self.at(t));
            }
            return;
        }
        // Half the derivative of the squared distance, at both ends.
        let slopes = ((start - p).dot(self.axis), (self.end - p).dot(self.end_axis));
        // It rises all along the leaf unless `p` lies about as far inside the bend as the bend's
        // centre. Along the leaf the offset changes by less than the leaf's turn times the distance.
        let offsets = [self.axis.perp_dot(p - start), self.end_axis.perp_dot(p - self.end)];
        let inside = [self.curve.start_curvature, self.curve.end_curvature]
            .into_iter()
            .flat_map(|k| offsets.map(|offset| k * offset))
            .fold(0.0, f64::max);
        let slack = LEAF_TURN * (start.distance(p) + length) * self.curve.max_curvature();
        let rises = inside + slack < 1.0;
        if rises && !(slopes.0 < 0.0 && slopes.1 > 0.0) {
            return;
        }
        let polynomial =
            Polynomial::new(start, self.axis, self.curve.start_curvature, self.curve.sharpness());
        if rises {
            let t = self.foot_between(&polynomial, p, (0.0, length));
            take(t, polynomial.position(t));
            return;
        }
        let mut before = (0.0, slopes.0);
        for k in 1..=PROBES {
            let t = length * k as f64 / PROBES as f64;
            let slope = (polynomial.position(t) - p).dot(polynomial.direction(t));
            if before.1 < 0.0 && slope >= 0.0 {
                let foot = self.foot_between(&polynomial, p, (before.0, t));
                take(foot, polynomial.position(foot));
            }
            before = (t, slope);
        }
    }

    /// Returns the position at which the perpendicular from `p` meets the line or circle that contains the leaf.
    fn foot_on_arc(&self, p: DVec2) -> f64 {
        let to = p - self.curve.start.position;
        let (x, y) = (self.axis.dot(to), self.axis.perp_dot(to));
        let k = self.curve.start_curvature;
        if k == 0.0 { x } else { libm::atan2(k * x, 1.0 - k * y) / k }
    }

    /// Returns the position at which half the derivative of the squared distance to `p` is 0, between two positions
    /// where it changes sign, by Newton's method kept inside the bracket.
    fn foot_between(
        &self,
        polynomial: &Polynomial<DEGREE>,
        p: DVec2,
        (mut low, mut high): (f64, f64),
    ) -> f64 {
        // Begin at the foot on the chord, as if the leaf were straight.
        let (from, to) = (self.curve.start.position, self.end);
        let share = (p - from).dot(to - from) / to.distance_squared(from);
        let mut t = (share * self.curve.length).clamp(low, high);
        for _ in 0..60 {
            let direction = polynomial.direction(t);
            let from = polynomial.position(t) - p;
            let slope = from.dot(direction);
            if slope < 0.0 {
                low = t;
            } else {
                high = t;
            }
            let bend = 1.0 + self.curve.curvature_at(t) * direction.perp_dot(from);
            let mut next = t - slope / bend;
            if !(next >= low && next <= high) {
                next = 0.5 * (low + high);
            }
            if (next - t).abs() <= 1e-12 * self.curve.length {
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
