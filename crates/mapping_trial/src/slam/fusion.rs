//! Fusion of scan matches with wheel odometry: across walls the match counts, along them the wheels.

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use glam::{DMat3, DVec2, DVec3};

use super::track::Variance;
use super::walls::WallPiece;

/// Standard deviation in metres of an echo's distance from its wall in a match.
const WALL_DEVIATION: f64 = 0.03;

/// Standard deviation in metres of a step that does not depend on its length, since wheels also slip on
/// the spot.
const SLIP: f64 = 0.002;

/// Fraction of the squared normals below which walls do not hold a direction: twice the effect of range
/// noise on a straight wall.
const ROUGHNESS: f64 = 0.005;

/// The error that the wheels may have added to a pose since walls last held it, by direction: the
/// covariance of x, y (m) and heading (rad), relative to the map, not the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drift(DMat3);

impl Drift {
    /// No drift: a known pose.
    pub(super) const NONE: Drift = Drift(DMat3::ZERO);

    /// The drift after a step by `shift` metres. An error of the heading becomes one of the position.
    pub(super) fn after(self, step: Variance, shift: DVec2) -> Drift {
        let swing = DMat3::from_cols(DVec3::X, DVec3::Y, shift.perp().extend(1.0));
        let position = step.position + SLIP * SLIP;
        let added = DMat3::from_diagonal(DVec3::new(position, position, step.heading));
        Drift(swing * self.0 * swing.transpose() + added)
    }

    /// The drift that remains where walls hold the pose. Along a bare wall it stays.
    pub(super) fn held(self, walls: &[WallPiece], pose: Pose) -> Drift {
        let left = (information(walls, pose) + self.0.inverse()).inverse();
        if left.is_finite() { Drift(left) } else { self }
    }

    /// Standard deviation in metres along the worse direction.
    pub(super) fn deviation(&self) -> f64 {
        let (xx, xy, yy) = (self.0.x_axis.x, self.0.x_axis.y, self.0.y_axis.y);
        larger_eigenvalue(xx, xy, yy).max(0.0).sqrt()
    }

    /// Standard deviation of the heading in radians.
    pub(super) fn heading_deviation(&self) -> f64 {
        self.0.z_axis.z.max(0.0).sqrt()
    }
}

/// Returns the pose that agrees best with a match and with the wheels. `drift` is that of the expected
/// pose.
///
/// A match is an optimum of the likelihood. But if all walls run in one direction, nothing holds the
/// match along them: it follows their roughness, and is pulled back over every new wall, by some
/// percent of the path. Each echo on a known wall gives information on one direction, the wall's
/// normal, and on the turn by its lever arm. The match counts as far as this information reaches, and
/// the wheels count for the rest (a weighted least-squares solution, as in Censi, An accurate
/// closed-form estimate of ICP's covariance, ICRA 2007, <https://doi.org/10.1109/ROBOT.2007.363961>).
pub(super) fn fuse(walls: &[WallPiece], expected: Pose, matched: Pose, drift: Drift) -> Pose {
    let known = information(walls, matched);
    let shift = matched.position - expected.position;
    let turn = wrap_angle(matched.heading - expected.heading);
    let fused =
        (known + drift.0.inverse()).inverse() * (known * DVec3::new(shift.x, shift.y, turn));
    if !fused.is_finite() {
        return matched;
    }
    Pose {
        position: expected.position + DVec2::new(fused.x, fused.y),
        heading: wrap_angle(expected.heading + fused.z),
    }
}

/// Returns the information on a pose from echoes on known walls.
fn information(walls: &[WallPiece], pose: Pose) -> DMat3 {
    let heading = unit_vector(pose.heading);
    let weight = 1.0 / (WALL_DEVIATION * WALL_DEVIATION);
    let bare = bare_direction(walls).map(|bare| heading.rotate(bare));
    let mut known = DMat3::ZERO;
    for &(point, normal) in walls {
        let mut across = heading.rotate(normal);
        if let Some(bare) = bare {
            across -= bare * bare.dot(across);
        }
        let row = DVec3::new(across.x, across.y, normal.dot(point.perp()));
        known += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
    }
    known
}

/// The direction in the robot's frame in which walls give no information, because all of them are
/// parallel to it.
fn bare_direction(walls: &[WallPiece]) -> Option<DVec2> {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (_, normal) in walls {
        xx += normal.x * normal.x;
        xy += normal.x * normal.y;
        yy += normal.y * normal.y;
    }
    let larger = larger_eigenvalue(xx, xy, yy);
    let smaller = xx + yy - larger;
    // The eigenvector of the larger eigenvalue, from the better conditioned row.
    let held = if xx >= yy { DVec2::new(larger - yy, xy) } else { DVec2::new(xy, larger - xx) };
    let held = held.try_normalize()?;
    (smaller < ROUGHNESS * larger).then(|| held.perp())
}

/// The larger eigenvalue of a symmetric matrix.
fn larger_eigenvalue(xx: f64, xy: f64, yy: f64) -> f64 {
    0.5 * (xx + yy) + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Echoes every 10 cm on a wall 2 m to the left, along the heading.
    fn wall_on_the_left() -> Vec<WallPiece> {
        (-30..=30).map(|i| (DVec2::new(0.1 * f64::from(i), 2.0), DVec2::Y)).collect()
    }

    /// The drift of one step.
    fn step(distance: f64, turned: f64) -> Drift {
        Drift::NONE.after(Variance::of_motion(distance, turned), DVec2::new(distance, 0.0))
    }

    #[test]
    fn what_no_wall_holds_drifts_on() {
        let steps = (0..20).map(|_| Variance::of_motion(0.3, 0.05));
        let (mut along, mut blind) = (Drift::NONE, Drift::NONE);
        let pose = Pose::default();
        for motion in steps {
            let ahead = DVec2::new(0.3, 0.0);
            along = along.after(motion, ahead).held(&wall_on_the_left(), pose);
            blind = blind.after(motion, ahead);
        }
        // The wall holds the heading and the position across it; the 6 m along it depend on the wheels.
        let wheels = Variance::of_motion(6.0, 0.0).position.sqrt();
        assert!((along.deviation() - wheels).abs() < 0.2 * wheels, "{along:?}");
        assert!(along.heading_deviation() < 0.01, "{along:?}");
        assert!(blind.deviation() > 2.0 * wheels && blind.heading_deviation() > 0.05, "{blind:?}");
        // A wall ahead ends it.
        let ahead = (-30..=30).map(|i| (DVec2::new(3.0, 0.1 * f64::from(i)), DVec2::X));
        let walls: Vec<WallPiece> = wall_on_the_left().into_iter().chain(ahead).collect();
        assert!(blind.held(&walls, pose).deviation() < 0.01);
    }

    #[test]
    fn the_match_counts_across_a_wall_and_the_wheels_along_it() {
        let expected = Pose::new(5.0, 5.0, 0.0);
        let matched = Pose::new(5.1, 5.1, 0.02);
        let motion = step(0.3, 0.26);
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
        let motion = step(0.3, 0.26);
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
        let fused = fuse(&wall_on_the_left(), expected, matched, step(0.0, 0.26));
        assert!(fused.position.distance(expected.position) < 0.03, "{fused:?}");
    }
}
