//! Headings and poses.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Returns the unit vector of a heading in radians. It has the same bits on every platform.
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
///
/// use envgen::geometry::unit_vector;
/// use envgen::glam::DVec2;
///
/// // Headings are counter-clockwise from +x: a quarter turn looks along +y.
/// assert_eq!(unit_vector(0.0), DVec2::X);
/// assert!(unit_vector(FRAC_PI_2).distance(DVec2::Y) < 1e-15);
/// ```
pub fn unit_vector(heading: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(heading);
    DVec2::new(cos, sin)
}

/// Returns the heading in (-pi, pi] that has the same direction.
///
/// ```
/// use std::f64::consts::PI;
///
/// use envgen::geometry::wrap_angle;
///
/// assert!((wrap_angle(1.5 * PI) + 0.5 * PI).abs() < 1e-12);
/// // Of the two ends of the range, pi belongs to it.
/// assert_eq!((wrap_angle(PI), wrap_angle(-PI)), (PI, PI));
/// ```
pub fn wrap_angle(heading: f64) -> f64 {
    let wrapped = libm::fmod(heading, TAU);
    if wrapped > PI {
        wrapped - TAU
    } else if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped
    }
}

/// A position in metres with a heading in radians.
///
/// A pose is the frame of a robot or a sensor, with x ahead and y to the left (ROS REP 103), given in another
/// frame, which is called the world's frame below. Poses form the group SE(2). Composed headings lie in (-pi, pi].
///
/// ```
/// use std::f64::consts::FRAC_PI_2;
///
/// use envgen::geometry::Pose;
/// use envgen::glam::DVec2;
///
/// // A robot that looks along +y, and its laser, 0.2 m ahead of its centre.
/// let (robot, laser) = (Pose::new(3.0, 1.0, FRAC_PI_2), Pose::new(0.2, 0.0, 0.0));
/// let echo = DVec2::new(2.0, 0.0);
/// let seen = robot.compose(laser).to_world(echo);
/// assert!(seen.distance(DVec2::new(3.0, 3.2)) < 1e-12);
/// assert!(robot.to_local(seen).distance(DVec2::new(2.2, 0.0)) < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Position in metres.
    pub position: DVec2,
    /// Heading in radians, counter-clockwise from +x.
    pub heading: f64,
}

impl Pose {
    /// Creates a pose at (`x`, `y`) metres with a heading in radians.
    pub const fn new(x: f64, y: f64, heading: f64) -> Self {
        Pose { position: DVec2::new(x, y), heading }
    }

    /// Returns in the world's frame the pose that is `relative` in this pose's frame.
    pub fn compose(self, relative: Pose) -> Pose {
        Pose {
            position: self.to_world(relative.position),
            heading: wrap_angle(self.heading + relative.heading),
        }
    }

    /// Returns the pose of the world's frame in this pose's frame.
    pub fn inverse(self) -> Pose {
        self.between(Pose::default())
    }

    /// Returns the pose `to` in this pose's frame, where both are given in the world's frame: the inverse of this
    /// pose, composed with `to`.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::geometry::Pose;
    ///
    /// // Both look along +y; the second is 2 m ahead of the first, and 1 m to its left.
    /// let (a, b) = (Pose::new(3.0, 1.0, FRAC_PI_2), Pose::new(2.0, 3.0, FRAC_PI_2));
    /// let seen = a.between(b);
    /// assert!(seen.position.distance(envgen::glam::DVec2::new(2.0, 1.0)) < 1e-12);
    /// assert_eq!(seen.heading, 0.0);
    /// assert!(a.compose(seen).position.distance(b.position) < 1e-12);
    /// ```
    pub fn between(self, to: Pose) -> Pose {
        Pose {
            position: self.to_local(to.position),
            heading: wrap_angle(to.heading - self.heading),
        }
    }

    /// Transforms a point in metres from this pose's frame into the world's frame.
    pub fn to_world(self, p: DVec2) -> DVec2 {
        self.local_to_world()(p)
    }

    /// Transforms a point in metres from the world's frame into this pose's frame.
    pub fn to_local(self, p: DVec2) -> DVec2 {
        self.world_to_local()(p)
    }

    /// Returns [`Pose::to_world`] as a function for many points, which computes sine and cosine only once.
    pub fn local_to_world(self) -> impl Fn(DVec2) -> DVec2 + Copy {
        let ahead = unit_vector(self.heading);
        move |p| self.position + ahead.rotate(p)
    }

    /// Returns [`Pose::to_local`] as a function for many points, which computes sine and cosine only once.
    pub fn world_to_local(self) -> impl Fn(DVec2) -> DVec2 + Copy {
        let back = unit_vector(-self.heading);
        move |p| back.rotate(p - self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wrapped_angles_point_in_the_same_direction() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(5.0 * PI) - PI).abs() < 1e-12);
        assert_eq!(wrap_angle(0.25), 0.25);
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (-50.0..50.0_f64, -50.0..50.0_f64, -7.0..7.0_f64).prop_map(|(x, y, h)| Pose::new(x, y, h))
    }

    fn alike(a: Pose, b: Pose) -> bool {
        a.position.distance(b.position) < 1e-9 && wrap_angle(a.heading - b.heading).abs() < 1e-9
    }

    #[test]
    fn x_is_ahead_and_y_to_the_left() {
        let pose = Pose::new(1.0, 2.0, PI / 2.0);
        assert!(pose.to_world(DVec2::X).distance(DVec2::new(1.0, 3.0)) < 1e-15);
        assert!(pose.to_world(DVec2::Y).distance(DVec2::new(0.0, 2.0)) < 1e-15);
        let there = pose.compose(Pose::new(1.0, 1.0, PI));
        assert!(alike(there, Pose::new(0.0, 3.0, -PI / 2.0)), "{there:?}");
    }

    proptest! {
        #[test]
        fn poses_are_a_group(a in pose(), b in pose(), c in pose()) {
            prop_assert!(alike(a.compose(b.compose(c)), a.compose(b).compose(c)));
            prop_assert!(alike(a.compose(Pose::default()), a));
            prop_assert!(alike(Pose::default().compose(a), a));
            prop_assert!(alike(a.compose(a.inverse()), Pose::default()));
            prop_assert!(alike(a.inverse().compose(a), Pose::default()));
            prop_assert!(alike(a.inverse().inverse(), a));
        }

        #[test]
        fn between_undoes_compose(a in pose(), b in pose()) {
            prop_assert!(alike(a.between(a.compose(b)), b));
            prop_assert!(alike(a.compose(a.between(b)), b));
            prop_assert!(alike(a.between(b), a.inverse().compose(b)));
            prop_assert!(a.compose(b).heading.abs() <= PI && a.between(b).heading.abs() <= PI);
        }

        #[test]
        fn points_return(a in pose(), b in pose(), x in -50.0..50.0_f64, y in -50.0..50.0_f64) {
            let p = DVec2::new(x, y);
            prop_assert!(a.to_local(a.to_world(p)).distance(p) < 1e-9);
            prop_assert!(a.to_world(a.to_local(p)).distance(p) < 1e-9);
            prop_assert!(a.compose(b).to_world(p).distance(a.to_world(b.to_world(p))) < 1e-9);
            prop_assert!(a.inverse().to_world(p).distance(a.to_local(p)) < 1e-9);
        }

        #[test]
        fn wrap_angle_stays_in_range(heading in -1e6..1e6_f64) {
            let wrapped = wrap_angle(heading);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!(unit_vector(wrapped).distance(unit_vector(heading)) < 1e-9);
        }
    }
}
