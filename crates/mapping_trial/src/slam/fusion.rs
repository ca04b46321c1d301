//! What to believe of a match: across walls the match, along them the wheels.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DMat3, DVec2, DVec3};

use super::mapper::WallPiece;
use super::track::Variance;

/// Standard deviation in metres of an echo's distance from its wall in a match.
const WALL_DEVIATION: f64 = 0.03;

/// Standard deviation in metres of a step that does not come from its length: wheels slip on the
/// spot too.
const SLIP: f64 = 0.002;

/// The pose that agrees best with a match and with what the wheels expect; `motion` is the variance
/// of the way from the last keyframe.
///
/// A match is an optimum of the likelihood, but where all walls run one way nothing holds it along
/// them: it follows their roughness, and is pulled back over every wall that is new, by some percent
/// of the way. Each echo on a known wall tells of one direction, the wall's normal, and of the turn
/// by its lever; the match is believed as far as they reach, the wheels for the rest (a weighted
/// least-squares solution, as in Censi, Lecture Notes on ICP's covariance, ICRA 2007).
pub(super) fn fuse(walls: &[WallPiece], expected: Pose, matched: Pose, motion: Variance) -> Pose {
    let heading = unit_vector(matched.heading);
    let weight = 1.0 / (WALL_DEVIATION * WALL_DEVIATION);
    let mut known = DMat3::ZERO;
    for &(point, normal) in walls {
        let across = heading.rotate(normal);
        let row = DVec3::new(across.x, across.y, normal.dot(point.perp()));
        known += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
    }
    let position = 1.0 / (motion.position + SLIP * SLIP);
    let wheels = DMat3::from_diagonal(DVec3::new(position, position, 1.0 / motion.heading));
    let shift = matched.position - expected.position;
    let turn = wrap_angle(matched.heading - expected.heading);
    let fused = (known + wheels).inverse() * (known * DVec3::new(shift.x, shift.y, turn));
    if !fused.is_finite() {
        return matched;
    }
    Pose {
        position: expected.position + DVec2::new(fused.x, fused.y),
        heading: wrap_angle(expected.heading + fused.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Echoes every 10 cm on a wall 2 m to the left, along the heading.
    fn wall_on_the_left() -> Vec<WallPiece> {
        (-30..=30).map(|i| (DVec2::new(0.1 * f64::from(i), 2.0), DVec2::Y)).collect()
    }

    #[test]
    fn the_match_counts_across_a_wall_and_the_wheels_along_it() {
        let expected = Pose::new(5.0, 5.0, 0.0);
        let matched = Pose::new(5.1, 5.1, 0.02);
        let motion = Variance::of_motion(0.3, 0.26);
        let fused = fuse(&wall_on_the_left(), expected, matched, motion);
        assert!((fused.position.x - 5.0).abs() < 0.01, "{fused:?}");
        assert!((fused.position.y - 5.1).abs() < 0.01, "{fused:?}");
        assert!((fused.heading - 0.02).abs() < 0.002, "{fused:?}");
        // The same, turned by a right angle.
        let turned = |pose: Pose| Pose {
            position: pose.position.perp(),
            heading: pose.heading + std::f64::consts::FRAC_PI_2,
        };
        let other = fuse(&wall_on_the_left(), turned(expected), turned(matched), motion);
        assert!(other.position.distance(turned(fused).position) < 1e-9, "{other:?}");
    }

    #[test]
    fn two_walls_hold_everything_and_none_nothing() {
        let expected = Pose::new(5.0, 5.0, 0.0);
        let matched = Pose::new(5.1, 5.1, 0.02);
        let motion = Variance::of_motion(0.3, 0.26);
        let mut walls = wall_on_the_left();
        walls.extend((-30..=30).map(|i| (DVec2::new(3.0, 0.1 * f64::from(i)), DVec2::X)));
        let fused = fuse(&walls, expected, matched, motion);
        assert!(fused.position.distance(matched.position) < 0.02, "{fused:?}");
        assert_eq!(fuse(&[], expected, matched, motion), expected);
    }

    #[test]
    fn a_turn_on_the_spot_moves_the_robot_little() {
        let expected = Pose::new(5.0, 5.0, 0.26);
        let matched = Pose::new(5.05, 5.0, 0.26);
        let fused = fuse(&wall_on_the_left(), expected, matched, Variance::of_motion(0.0, 0.26));
        assert!(fused.position.distance(expected.position) < 0.03, "{fused:?}");
    }
}
