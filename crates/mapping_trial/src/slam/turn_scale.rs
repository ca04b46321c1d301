//! The systematic error of the turns that a robot's wheels measure, learned where walls hold its heading.
//!
//! A skid-steered robot measures every turn too large or too small by the same share. Where nothing
//! is in sight the wheels alone carry the heading. Where walls hold it, the same turn is known twice,
//! and the ratio of both is the error (Martinelli et al., Simultaneous localization and odometry
//! self calibration for mobile robot, Autonomous Robots 22, 2007, <https://doi.org/10.1007/s10514-006-9006-7>).

use envgen::geometry::wrap_angle;

use super::motion::believable;
use crate::odometry::Increment;

/// Radians of turning with a ratio of 1 that unknown wheels are worth: the variance of a radian of turning
/// over that of the ratio from robot to robot.
const PRIOR: f64 = 2.0;

/// Greatest deviation of the ratio from 1.
const MOST: f64 = 0.2;

/// Least turn in radians from one keyframe to the next that is compared: less is mostly the error of the
/// matches.
const LEAST: f64 = 0.1;

/// Largest relative difference of a turn on the map from that of the wheels; a wrong match is farther off.
const BELIEVED: f64 = 0.5;

/// What is known of the turns of one robot, and its turn since its last keyframe.
#[derive(Clone, Debug)]
pub(crate) struct TurnScale {
    /// Radians on the map, and as the wheels measured them.
    on_map: f64,
    by_wheels: f64,
    turned: f64,
    /// Whether walls held the heading at the last keyframe.
    was_held: bool,
}

impl TurnScale {
    /// Wheels of which nothing is known.
    pub(crate) fn new() -> Self {
        TurnScale { on_map: PRIOR, by_wheels: PRIOR, turned: 0.0, was_held: false }
    }

    /// Takes what the wheels measured in a tick, and corrects it by what is known of them.
    pub(crate) fn correct(&mut self, measured: Increment) -> Increment {
        let measured = believable(measured);
        self.turned += measured.turn;
        let ratio = (self.on_map / self.by_wheels).clamp(1.0 - MOST, 1.0 + MOST);
        Increment { turn: measured.turn * ratio, ..measured }
    }

    /// Takes the turn from the last keyframe to a new one, as it is on the map; `is_held` is whether walls
    /// hold the new one's heading.
    pub(crate) fn keyframe(&mut self, turn: f64, is_held: bool) {
        let (on_map, by_wheels) = (wrap_angle(turn) * self.turned.signum(), self.turned.abs());
        // Judged on the map: of turns that the wheels measured as long enough, too many would be
        // measured as too long.
        let is_long = on_map >= LEAST;
        let agrees = (on_map - by_wheels).abs() <= BELIEVED * by_wheels;
        if self.was_held && is_held && is_long && agrees {
            self.on_map += on_map;
            self.by_wheels += by_wheels;
        }
        (self.was_held, self.turned) = (is_held, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use proptest::prelude::*;

    use super::*;
    use crate::odometry::{Odometry, OdometryProfile, WheelSensor};

    /// Drives arcs with a keyframe after each, on wheels whose turns are multiplied by a factor,
    /// and returns how 1 rad is then measured.
    fn learned(factor: f64, is_held: bool) -> f64 {
        let profile = OdometryProfile { b_s: 0.0, b_t: 0.0, ..OdometryProfile::SKID };
        let mut wheels = Odometry::new(profile, Seed(3), 0);
        let mut matches = Seed(3).stream("matches", 0);
        let mut scale = TurnScale::new();
        scale.keyframe(0.0, is_held);
        for arc in 0..600 {
            let turn = [0.02, -0.015, 0.0, 0.01][arc % 4];
            for _ in 0..12 {
                let measured = wheels.measure(Increment { distance: 0.025, turn }, 1.0);
                scale.correct(Increment { turn: measured.turn * factor, ..measured });
            }
            scale.keyframe(12.0 * turn + matches.between(-0.005, 0.005), is_held);
        }
        scale.correct(Increment { distance: 0.0, turn: factor }).turn
    }

    #[test]
    fn wheels_that_are_off_are_known_after_some_turns() {
        for factor in [0.9, 1.0, 1.1] {
            let turn = learned(factor, true);
            assert!((turn - 1.0).abs() < 0.012, "{factor}: {turn} rad");
        }
        assert!((learned(1.28, true) - 1.28 * (1.0 - MOST)).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_learned_where_no_wall_holds_the_heading() {
        assert_eq!(learned(0.9, false).to_bits(), 0.9_f64.to_bits());
    }

    #[test]
    fn a_wrong_match_is_no_measurement_of_the_wheels() {
        let mut scale = TurnScale::new();
        scale.keyframe(0.0, true);
        scale.correct(Increment { distance: 0.0, turn: 0.2 });
        scale.keyframe(-0.2, true);
        let step = Increment { distance: 0.1, turn: 0.1 };
        assert_eq!(scale.correct(step), step);
    }

    proptest! {
        #[test]
        fn no_measurement_breaks_it(
            turns in prop::collection::vec((any::<f64>(), any::<f64>(), -4.0..4.0_f64), 0..20),
        ) {
            let mut scale = TurnScale::new();
            for (distance, turn, on_map) in turns {
                let found = scale.correct(Increment { distance, turn });
                prop_assert!(found.distance.is_finite() && found.turn.is_finite());
                scale.keyframe(on_map, true);
            }
            let one = scale.correct(Increment { distance: 1.0, turn: 1.0 });
            prop_assert!((one.turn - 1.0).abs() <= MOST + 1e-12);
        }
    }
}
