//! The sections of a ray that lie in regions of smoke.

use glam::DVec2;

use crate::geometry::{Shape, box_axis, edges};

/// A section of a ray that lies in smoke of one density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Distance along the ray at which it begins, in metres.
    pub from: f64,
    /// Distance along the ray at which it ends, in metres.
    pub to: f64,
    /// Extinction coefficient in 1/m.
    pub extinction: f64,
    /// Whether it is particle smoke, which stops every beam of `USARSim`.
    pub is_particle: bool,
}

/// Calls `visit` with the parts of a ray, between 0 and `length` metres, that lie inside a shape.
pub(super) fn chords(
    shape: &Shape,
    from: DVec2,
    direction: DVec2,
    length: f64,
    mut visit: impl FnMut(f64, f64),
) {
    let mut clipped = |enter: f64, leave: f64| {
        let (enter, leave) = (enter.max(0.0), leave.min(length));
        if enter < leave {
            visit(enter, leave);
        }
    };
    match shape {
        Shape::Segment { .. } => {}
        Shape::Disc { center, radius } => {
            let to = center - from;
            let (middle, off) = (to.dot(direction), to.perp_dot(direction));
            let half2 = radius * radius - off * off;
            if half2 > 0.0 {
                clipped(middle - half2.sqrt(), middle + half2.sqrt());
            }
        }
        Shape::Box { center, half_size, heading } => {
            let axis = box_axis(*heading);
            let local = |v: DVec2| DVec2::new(v.dot(axis), axis.perp_dot(v));
            let (from, direction) = (local(from - center), local(direction));
            let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
            for (p, d, half) in
                [(from.x, direction.x, half_size.x), (from.y, direction.y, half_size.y)]
            {
                if d == 0.0 {
                    if p.abs() >= half {
                        return;
                    }
                } else {
                    let (a, b) = ((-half - p) / d, (half - p) / d);
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
            }
            clipped(enter, leave);
        }
        Shape::Polygon { vertices } => {
            let mut crossings: Vec<f64> = edges(vertices)
                .filter_map(|(a, b)| {
                    // Half-open sides, so that a corner counts once.
                    let (a, b) = (a - from, b - from);
                    let (s, t) = (direction.perp_dot(a), direction.perp_dot(b));
                    ((s > 0.0) != (t > 0.0)).then(|| (a + (b - a) * (s / (s - t))).dot(direction))
                })
                .collect();
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                clipped(pair[0], pair[1]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::unit_vector;
    use proptest::prelude::*;

    fn length(shape: &Shape, from: DVec2, heading: f64, reach: f64) -> f64 {
        let mut sum = 0.0;
        chords(shape, from, unit_vector(heading), reach, |a, b| sum += b - a);
        sum
    }

    #[test]
    fn chords_by_hand() {
        let v = DVec2::new;
        let disc = Shape::Disc { center: v(5.0, 0.0), radius: 2.0 };
        assert_eq!(length(&disc, DVec2::ZERO, 0.0, 20.0), 4.0);
        assert_eq!(length(&disc, DVec2::ZERO, 0.0, 4.0), 1.0);
        assert_eq!(length(&disc, v(5.0, 0.0), 0.0, 20.0), 2.0);
        let off = length(&disc, v(0.0, 1.0), 0.0, 20.0);
        assert!((off - 2.0 * 3.0_f64.sqrt()).abs() < 1e-12);
        let square = Shape::Box { center: v(3.0, 0.0), half_size: v(1.0, 1.0), heading: 0.0 };
        assert_eq!(length(&square, DVec2::ZERO, 0.0, 20.0), 2.0);
        let turned = Shape::Box {
            center: v(3.0, 0.0),
            half_size: v(1.0, 1.0),
            heading: 0.25 * std::f64::consts::PI,
        };
        assert!((length(&turned, DVec2::ZERO, 0.0, 20.0) - 8.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(length(&square, DVec2::ZERO, 2.0, 20.0), 0.0);
    }

    proptest! {
        #[test]
        fn a_chord_is_where_points_are_inside(
            center in (-3.0..3.0, -3.0..3.0), half in (0.1..3.0, 0.1..3.0), turn in -4.0..4.0_f64,
            from in (-6.0..6.0, -6.0..6.0), heading in -4.0..4.0_f64, reach in 0.1..12.0_f64,
        ) {
            let half_size: DVec2 = half.into();
            let rectangle = Shape::Box { center: center.into(), half_size, heading: turn };
            let polygon = Shape::Polygon { vertices: rectangle.corners() };
            let disc = Shape::Disc { center: center.into(), radius: half_size.x };
            let from = DVec2::from(from);
            for shape in [&rectangle, &disc] {
                // By counting points along the ray.
                let points = 2000;
                let direction = unit_vector(heading);
                let at = |i: i32| from + direction * reach * (f64::from(i) + 0.5) / f64::from(points);
                let inside = (0..points).filter(|&i| shape.contains(at(i))).count() as f64;
                let counted = inside * reach / f64::from(points);
                let exact = length(shape, from, heading, reach);
                prop_assert!((exact - counted).abs() <= 1.1 * reach / f64::from(points));
            }
            let difference =
                length(&rectangle, from, heading, reach) - length(&polygon, from, heading, reach);
            prop_assert!(difference.abs() < 1e-9);
        }
    }
}
