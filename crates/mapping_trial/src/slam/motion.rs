//! Propagation of poses by increments of odometry.

use envgen::geometry::{Pose, unit_vector, wrap_angle};

use crate::odometry::Increment;

/// Greatest distance in metres and greatest turn in radians of one increment; larger values are
/// clamped.
const BELIEVED: f64 = 1e4;

/// Greatest distance of a pose from the origin in metres; poses farther away are noise.
const FARTHEST: f64 = 1e9;

/// The pose after a motion, as the chord of a small arc.
pub(crate) fn advance(pose: Pose, by: Increment) -> Pose {
    let middle = unit_vector(pose.heading + 0.5 * by.turn);
    let position = pose.position + middle * by.distance;
    Pose {
        position: position.clamp(glam::DVec2::splat(-FARTHEST), glam::DVec2::splat(FARTHEST)),
        heading: wrap_angle(pose.heading + by.turn),
    }
}

/// Removes impossible values from an increment: NaN counts as no motion, and huge values are clamped.
pub(crate) fn believable(increment: Increment) -> Increment {
    let part = |x: f64| if x.is_nan() { 0.0 } else { x.clamp(-BELIEVED, BELIEVED) };
    Increment { distance: part(increment.distance), turn: part(increment.turn) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn any_increments_leave_a_pose_finite(distance in any::<f64>(), turn in any::<f64>()) {
            let mut pose = Pose::new(FARTHEST, -FARTHEST, 1.0);
            for _ in 0..3 {
                pose = advance(pose, believable(Increment { distance, turn }));
            }
            prop_assert!(pose.position.is_finite() && pose.heading.abs() <= std::f64::consts::PI);
        }
    }

    #[test]
    fn a_quarter_circle_in_small_steps_ends_where_it_should() {
        let steps = 400;
        let quarter = std::f64::consts::FRAC_PI_2;
        let by = Increment {
            distance: 2.0 * quarter / f64::from(steps),
            turn: quarter / f64::from(steps),
        };
        let end = (0..steps).fold(Pose::default(), |pose, _| advance(pose, by));
        assert!(end.position.distance(glam::DVec2::new(2.0, 2.0)) < 1e-5, "{end:?}");
    }
}
