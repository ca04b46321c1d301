//! Headings and poses.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// The unit vector of a heading in radians, the same bits on every platform.
pub fn unit_vector(heading: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(heading);
    DVec2::new(cos, sin)
}

/// The same direction as a heading in (-pi, pi].
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Position in metres.
    pub position: DVec2,
    /// Heading in radians, counter-clockwise from +x.
    pub heading: f64,
}

impl Pose {
    /// A pose at (`x`, `y`) metres.
    pub const fn new(x: f64, y: f64, heading: f64) -> Self {
        Pose { position: DVec2::new(x, y), heading }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wrapped_angles_point_the_same_way() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(5.0 * PI) - PI).abs() < 1e-12);
        assert_eq!(wrap_angle(0.25), 0.25);
    }

    proptest! {
        #[test]
        fn wrap_angle_stays_in_range(heading in -1e6..1e6_f64) {
            let wrapped = wrap_angle(heading);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!(unit_vector(wrapped).distance(unit_vector(heading)) < 1e-9);
        }
    }
}
