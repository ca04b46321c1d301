//! The convex pieces of which solid parts consist, and distances between them.

use glam::DVec2;

use crate::geometry::{Rect, Shape, box_axis, edges};

/// A rectangle, a line or a point (depending on `half_size`), and everything within `radius` of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) center: DVec2,
    /// Direction of the width.
    axis: DVec2,
    half_size: DVec2,
    pub(super) radius: f64,
}

/// The two points of the cores of two pieces that are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    pub(super) points: [DVec2; 2],
    /// Distance between the pieces; not positive if they overlap.
    pub(super) distance: f64,
}

impl Piece {
    /// The number of pieces of a shape, which is also what looking at all of it costs.
    pub(super) fn count(shape: &Shape) -> usize {
        match shape {
            Shape::Polygon { vertices } => vertices.len(),
            _ => 1,
        }
    }

    /// Calls `visit` with the pieces of a shape. A polygon becomes its sides, which separate inside from outside as
    /// well as the whole polygon does.
    pub(super) fn of(shape: &Shape, mut visit: impl FnMut(Piece)) {
        match shape {
            Shape::Segment { a, b } => visit(Piece::line(*a, *b)),
            Shape::Disc { center, radius } => visit(Piece {
                center: *center,
                axis: DVec2::X,
                half_size: DVec2::ZERO,
                radius: *radius,
            }),
            Shape::Box { center, half_size, heading } => visit(Piece {
                center: *center,
                axis: box_axis(*heading),
                half_size: *half_size,
                radius: 0.0,
            }),
            Shape::Polygon { vertices } => {
                edges(vertices).for_each(|(a, b)| visit(Piece::line(a, b)));
            }
        }
    }

    fn line(a: DVec2, b: DVec2) -> Piece {
        let along = b - a;
        let length = along.length();
        let axis = if length > 0.0 { along / length } else { DVec2::X };
        let half_size = DVec2::new(0.5 * length, 0.0);
        Piece { center: 0.5 * (a + b), axis, half_size, radius: 0.0 }
    }

    pub(super) fn is_round(&self) -> bool {
        self.half_size == DVec2::ZERO
    }

    fn into_local(self, p: DVec2) -> DVec2 {
        let offset = p - self.center;
        DVec2::new(offset.dot(self.axis), self.axis.perp_dot(offset))
    }

    fn to_world(self, local: DVec2) -> DVec2 {
        self.center + self.axis * local.x + self.axis.perp() * local.y
    }

    /// Returns the corners of the core enlarged by `margin`, counter-clockwise.
    pub(super) fn corners(&self, margin: f64) -> [DVec2; 4] {
        let half = self.half_size + margin;
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| self.to_world(half * DVec2::new(x, y)))
    }

    pub(super) fn bounds(&self) -> Rect {
        let axis = self.axis.abs();
        let half = self.half_size;
        let half = DVec2::new(axis.x * half.x + axis.y * half.y, axis.y * half.x + axis.x * half.y);
        Rect::new(self.center - half, self.center + half).grown(self.radius)
    }

    /// Returns the point of the piece that is farthest in the direction of a unit vector.
    pub(super) fn farthest(&self, direction: DVec2) -> DVec2 {
        let local = DVec2::new(direction.dot(self.axis), self.axis.perp_dot(direction));
        self.to_world(self.half_size * local.signum()) + direction * self.radius
    }

    /// Returns the point of the core that is nearest to a point.
    fn nearest(&self, p: DVec2) -> DVec2 {
        let local = self.into_local(p);
        let inside = local.clamp(-self.half_size, self.half_size);
        if local == inside { p } else { self.to_world(inside) }
    }

    /// Returns the distance from a point, which is negative inside a disc and 0 inside another piece.
    pub(super) fn distance(&self, p: DVec2) -> f64 {
        let outside = (self.into_local(p).abs() - self.half_size).max(DVec2::ZERO);
        outside.length() - self.radius
    }

    /// Whether a line along a side of one of two pieces keeps them more than `reach` apart: a fast test before
    /// [`gap`](Self::gap).
    pub(super) fn is_parted(&self, other: &Piece, reach: f64) -> bool {
        let reach = reach + self.radius + other.radius;
        let beside = |a: &Piece, b: &Piece| {
            let offset = a.into_local(b.center).abs();
            let (cos, sin) = (a.axis.dot(b.axis).abs(), a.axis.perp_dot(b.axis).abs());
            let half = DVec2::new(
                cos * b.half_size.x + sin * b.half_size.y,
                sin * b.half_size.x + cos * b.half_size.y,
            );
            (offset - a.half_size - half).max_element() > reach
        };
        beside(self, other) || beside(other, self)
    }

    /// Returns the distance between two pieces; `None` if it is more than `reach`.
    pub(super) fn gap(&self, other: &Piece, reach: f64) -> Option<Gap> {
        let gap = |a: DVec2, b: DVec2| {
            let distance = a.distance(b) - self.radius - other.radius;
            Gap { points: [a, b], distance }
        };
        let apart = self.center.distance(other.center) - self.radius - other.radius;
        if self.is_round() && other.is_round() {
            return (apart <= reach).then(|| gap(self.center, other.center));
        }
        // Of two that are apart one of the nearest points is a corner.
        let mine = self.core_corners().map(|corner| [corner, other.nearest(corner)]);
        let others = other.core_corners().map(|corner| [self.nearest(corner), corner]);
        let length2 = |[a, b]: &[DVec2; 2]| a.distance_squared(*b);
        let [a, b] = mine
            .chain(others)
            .reduce(|best, pair| if length2(&pair) < length2(&best) { pair } else { best })?;
        let nearest = gap(a, b);
        if a == b {
            return Some(nearest);
        }
        // Two that overlap without a corner of one in the other cross with their sides.
        if let Some(p) = self.crossing(other) {
            return Some(gap(p, p));
        }
        (nearest.distance <= reach).then_some(nearest)
    }

    /// Returns the corners of the core: four, two or one.
    fn core_corners(&self) -> impl Iterator<Item = DVec2> + use<> {
        let count = match (self.half_size.x > 0.0, self.half_size.y > 0.0) {
            (true, true) => 4,
            (false, false) => 1,
            _ => 2,
        };
        // The first two of a line along x are its ends; one along y takes the second and third.
        let skip = usize::from(count == 2 && self.half_size.x == 0.0);
        self.corners(0.0).into_iter().skip(skip).take(count)
    }

    /// Returns a point of the core's sides that lies inside the other's core.
    fn crossing(&self, other: &Piece) -> Option<DVec2> {
        let corners = self.corners(0.0);
        edges(&corners).find_map(|(a, b)| {
            let (from, to) = (other.into_local(a), other.into_local(b));
            let (mut low, mut high) = (0.0_f64, 1.0_f64);
            for axis in 0..2 {
                let (start, along, half) =
                    (from[axis], to[axis] - from[axis], other.half_size[axis]);
                if along == 0.0 {
                    if start.abs() > half {
                        return None;
                    }
                    continue;
                }
                let (s, t) = ((-half - start) / along, (half - start) / along);
                low = low.max(s.min(t));
                high = high.min(s.max(t));
            }
            (low <= high).then(|| a.lerp(b, 0.5 * (low + high)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shapes() -> impl Strategy<Value = Shape> {
        let point = || (-3.0..3.0, -3.0..3.0).prop_map(|(x, y)| DVec2::new(x, y));
        let heading = prop_oneof![Just(0.0), Just(std::f64::consts::FRAC_PI_2), -4.0..4.0];
        prop_oneof![
            (point(), point()).prop_map(|(a, b)| Shape::Segment { a, b }),
            (point(), 0.01..2.0).prop_map(|(center, radius)| Shape::Disc { center, radius }),
            (point(), (0.01..3.0, 0.01..3.0), heading).prop_map(|(center, half, heading)| {
                Shape::Box { center, half_size: DVec2::new(half.0, half.1), heading }
            }),
        ]
    }

    fn piece(shape: &Shape) -> Piece {
        let mut found = None;
        Piece::of(shape, |piece| found = Some(piece));
        found.unwrap()
    }

    /// Side of the lattice from which places on shapes are sought.
    const H: f64 = 0.125;

    /// Distance between two shapes, at most H / sqrt 2 too much: by the places on the one that are
    /// nearest to the points of a lattice.
    fn by_lattice(a: &Shape, b: &Shape) -> f64 {
        let points =
            (-56..=56).flat_map(|x| (-56..=56).map(move |y| DVec2::new(x.into(), y.into())));
        points.map(|p| b.distance(a.nearest_point(p * H))).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn gaps_are_those_of_a_lattice(a in shapes(), b in shapes()) {
            let slow = by_lattice(&a, &b);
            let gap = piece(&a).gap(&piece(&b), f64::INFINITY).unwrap();
            let distance = gap.distance.max(0.0);
            prop_assert!(distance <= slow + 1e-9, "{gap:?} {slow}");
            prop_assert!(distance >= slow - H * std::f64::consts::FRAC_1_SQRT_2, "{gap:?} {slow}");
            let [p, q] = gap.points;
            prop_assert!(a.distance(p) < 1e-9 && b.distance(q) < 1e-9);
            let reach = 0.5 * slow;
            prop_assert_eq!(piece(&a).gap(&piece(&b), reach).is_some(), gap.distance <= reach);
            // What is parted is that far apart.
            for reach in [0.25 * distance, 0.75 * distance, distance + 1e-9] {
                let parted = piece(&a).is_parted(&piece(&b), reach);
                prop_assert!(!parted || distance > reach, "{reach}: {gap:?}");
            }
        }

        #[test]
        fn a_piece_is_its_shape(a in shapes(), x in -6.0..6.0_f64, y in -6.0..6.0_f64) {
            let (p, piece) = (DVec2::new(x, y), piece(&a));
            prop_assert!((piece.distance(p).max(0.0) - a.distance(p)).abs() < 1e-12);
            let (bounds, rect) = (piece.bounds(), a.bounds());
            prop_assert!(bounds.min.distance(rect.min) < 1e-9);
            prop_assert!(bounds.max.distance(rect.max) < 1e-9);
            let far = piece.farthest(DVec2::NEG_X);
            prop_assert!((far.x - rect.min.x).abs() < 1e-9 && a.distance(far) < 1e-9);
        }
    }
}
