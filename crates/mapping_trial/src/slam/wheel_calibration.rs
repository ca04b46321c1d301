//! Calibration of wheel odometry: the systematic errors of the wheels are learned where walls hold the
//! pose.
//!
//! A skid-steered robot measures all turns too large or too small by one factor, and all distances by
//! another. Where nothing is in sight, the wheels alone determine the pose. Where walls hold it, the
//! same motion is known twice, and the ratio of the two values is the error (Martinelli et al.,
//! Simultaneous localization and odometry self calibration for mobile robot, Autonomous Robots 22,
//! 2007, <https://doi.org/10.1007/s10514-006-9006-7>).

use envgen::geometry::{Pose, unit_vector, wrap_angle};
use serde::{Deserialize, Serialize};

use super::fusion::Drift;
use super::motion::believable;
use crate::odometry::Increment;

/// The systematic errors of the wheels that an estimator learns while it matches scans.
///
/// If distances are learned, too, the poses in buildings of 30 m are off by a sixth less, and a third
/// as many by more than 0.3 m. But what was mapped before a scale is known does not fit what is mapped
/// after. Where a loop through long corridors comes back, the gap is larger, and
/// [`PoseGraph`](super::PoseGraph) closes it less often.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum WheelCalibration {
    /// No errors: every increment counts as it is measured.
    None,
    /// The error of turns.
    #[default]
    Turns,
    /// The errors of turns and of distances.
    TurnsAndDistances,
}

impl WheelCalibration {
    /// Whether files omit it, as those do that are older than this setting.
    pub(crate) fn is_default(&self) -> bool {
        *self == WheelCalibration::default()
    }
}

/// Weight of the prior that the ratio is 1, in radians of turning: the variance of a radian of turning
/// divided by that of the ratio from robot to robot.
const TURN_PRIOR: f64 = 2.0;

/// Weight of the prior that the ratio of distances is 1, in metres, likewise.
const DISTANCE_PRIOR: f64 = 3.0;

/// Greatest deviation of a ratio from 1.
const MOST: f64 = 0.2;

/// Least turn in radians, and least distance in metres, from one keyframe to the next that are
/// compared. Smaller ones are mostly errors of the matches.
const LEAST_TURN: f64 = 0.1;
const LEAST_DISTANCE: f64 = 0.15;

/// Greatest turning in radians between keyframes whose distance is compared, since a chord is shorter
/// than its arc.
const STRAIGHT: f64 = 0.1;

/// Greatest relative difference between a motion on the map and by the wheels. A wrong match differs
/// more.
const BELIEVED: f64 = 0.5;

/// Greatest standard deviations of the drift, in radians and in metres along the worse direction, with
/// which walls hold a pose well enough to measure the wheels by it. For a single step a larger
/// deviation of the position would do. But matches of weakly held positions are pulled by what is new
/// in a scan, in corridors by 1 % of the distance.
const HELD_HEADING: f64 = 0.01;
const HELD_POSITION: f64 = 0.008;

/// The sums of the same motions on the map and by the wheels.
#[derive(Clone, Copy, Debug)]
struct Compared {
    on_map: f64,
    by_wheels: f64,
}

impl Compared {
    fn new(prior: f64) -> Self {
        Compared { on_map: prior, by_wheels: prior }
    }

    /// The factor by which a measurement of the wheels is to be multiplied.
    fn ratio(&self) -> f64 {
        (self.on_map / self.by_wheels).clamp(1.0 - MOST, 1.0 + MOST)
    }

    /// Adds a signed motion, if it is long enough and if both values agree.
    fn add(&mut self, on_map: f64, by_wheels: f64, least: f64) {
        let (on_map, by_wheels) = (on_map * by_wheels.signum(), by_wheels.abs());
        // The length is judged on the map. If it were judged by the wheels, too many of the chosen
        // motions would be measured as too long.
        let is_long = on_map >= least;
        if is_long && (on_map - by_wheels).abs() <= BELIEVED * by_wheels {
            self.on_map += on_map;
            self.by_wheels += by_wheels;
        }
    }
}

/// What is known of one robot's wheels, and its motion since its last keyframe.
#[derive(Clone, Debug)]
pub(crate) struct WheelScales {
    learns: WheelCalibration,
    turns: Compared,
    distances: Compared,
    /// The turn, the turning left and right added, and the distance as measured since then.
    turn: f64,
    turned: f64,
    distance: f64,
    /// Whether walls held heading and position at the last keyframe.
    held: (bool, bool),
}

impl WheelScales {
    /// Wheels of which nothing is known.
    pub(crate) fn new(learns: WheelCalibration) -> Self {
        WheelScales {
            learns,
            turns: Compared::new(TURN_PRIOR),
            distances: Compared::new(DISTANCE_PRIOR),
            turn: 0.0,
            turned: 0.0,
            distance: 0.0,
            held: (false, false),
        }
    }

    /// Takes what the wheels measured in a tick, and returns it corrected by what is known of them.
    pub(crate) fn correct(&mut self, measured: Increment) -> Increment {
        let measured = believable(measured);
        self.turn += measured.turn;
        self.turned += measured.turn.abs();
        self.distance += measured.distance;
        Increment {
            turn: measured.turn * self.turns.ratio(),
            distance: measured.distance * self.distances.ratio(),
        }
    }

    /// Processes the poses of the last keyframe and of a new one, and the drift of the new one that
    /// walls leave.
    pub(crate) fn keyframe(&mut self, last: Pose, new: Pose, drift: &Drift) {
        let held = (drift.heading_deviation() <= HELD_HEADING, drift.deviation() <= HELD_POSITION);
        let turn = wrap_angle(new.heading - last.heading);
        if self.learns >= WheelCalibration::Turns && self.held.0 && held.0 {
            self.turns.add(turn, self.turn, LEAST_TURN);
        }
        let learns_distances = self.learns >= WheelCalibration::TurnsAndDistances;
        if learns_distances && self.held.1 && held.1 && self.turned <= STRAIGHT {
            let ahead = unit_vector(last.heading + 0.5 * turn);
            self.distances.add(
                (new.position - last.position).dot(ahead),
                self.distance,
                LEAST_DISTANCE,
            );
        }
        (self.turn, self.turned, self.distance, self.held) = (0.0, 0.0, 0.0, held);
    }
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use glam::DVec2;
    use proptest::prelude::*;

    use super::super::track::Variance;
    use super::*;
    use crate::odometry::{Odometry, OdometryProfile, WheelSensor};

    /// A pose that nothing holds.
    fn lost() -> Drift {
        Drift::NONE.after(Variance { position: 1.0, heading: 1.0 }, DVec2::ZERO)
    }

    /// Drives arcs and straight on with a keyframe after each, on wheels whose turns and distances are
    /// multiplied by factors, and returns how 1 m and 1 rad are then measured.
    fn learned(factors: [f64; 2], learns: WheelCalibration, drift: &Drift) -> Increment {
        let profile = OdometryProfile { b_s: 0.0, b_t: 0.0, ..OdometryProfile::SKID };
        let mut wheels = Odometry::new(profile, Seed(3), 0);
        let mut matches = Seed(3).stream("matches", 0);
        let mut scales = WheelScales::new(learns);
        let mut pose = Pose::default();
        scales.keyframe(pose, pose, drift);
        for arc in 0..600 {
            let turn = [0.02, -0.015, 0.0, 0.01][arc % 4];
            for _ in 0..12 {
                let measured = wheels.measure(Increment { distance: 0.025, turn }, 1.0);
                scales.correct(Increment {
                    distance: measured.distance * factors[0],
                    turn: measured.turn * factors[1],
                });
            }
            let half = unit_vector(pose.heading + 6.0 * turn);
            let off = matches.between(-0.005, 0.005);
            let next = Pose {
                position: pose.position + half * (0.3 + off),
                heading: wrap_angle(pose.heading + 12.0 * turn + off),
            };
            scales.keyframe(pose, next, drift);
            pose = next;
        }
        scales.correct(Increment { distance: factors[0], turn: factors[1] })
    }

    #[test]
    fn wheels_that_are_off_are_known_after_some_motion() {
        let learned = |factors| learned(factors, WheelCalibration::TurnsAndDistances, &Drift::NONE);
        for factor in [0.9, 1.0, 1.1] {
            let turn = learned([1.0, factor]).turn;
            assert!((turn - 1.0).abs() < 0.012, "{factor}: {turn} rad");
            let distance = learned([factor, 1.0]).distance;
            assert!((distance - 1.0).abs() < 0.012, "{factor}: {distance} m");
        }
        let far = learned([1.28, 1.28]);
        for measured in [far.distance, far.turn] {
            assert!((measured - 1.28 * (1.0 - MOST)).abs() < 1e-9, "{measured}");
        }
    }

    #[test]
    fn nothing_is_learned_that_is_not_asked_for() {
        let factors = [0.95, 0.9];
        let by = |learns| learned(factors, learns, &Drift::NONE);
        let raw = Increment { distance: factors[0], turn: factors[1] };
        assert_eq!(by(WheelCalibration::None), raw);
        let turns = by(WheelCalibration::Turns);
        let both = by(WheelCalibration::TurnsAndDistances);
        assert_eq!((turns.distance, turns.turn), (raw.distance, both.turn));
        assert!((both.distance - 1.0).abs() < 0.012, "{both:?}");
    }

    #[test]
    fn nothing_is_learned_where_no_wall_holds_the_pose() {
        let found = learned([0.9, 0.9], WheelCalibration::TurnsAndDistances, &lost());
        assert_eq!(found, Increment { distance: 0.9, turn: 0.9 });
    }

    #[test]
    fn a_wrong_match_is_no_measurement_of_the_wheels() {
        let mut scales = WheelScales::new(WheelCalibration::TurnsAndDistances);
        let start = Pose::default();
        scales.keyframe(start, start, &Drift::NONE);
        scales.correct(Increment { distance: 0.0, turn: 0.2 });
        scales.keyframe(start, Pose::new(0.0, 0.0, -0.2), &Drift::NONE);
        scales.correct(Increment { distance: 0.3, turn: 0.0 });
        scales.keyframe(start, Pose::new(0.7, 0.0, 0.0), &Drift::NONE);
        let step = Increment { distance: 0.1, turn: 0.1 };
        assert_eq!(scales.correct(step), step);
    }

    #[test]
    fn the_chord_of_a_bend_is_no_distance() {
        let mut scales = WheelScales::new(WheelCalibration::TurnsAndDistances);
        let start = Pose::default();
        scales.keyframe(start, start, &Drift::NONE);
        // Left and right: the heading is as before.
        for turn in [0.2, -0.2] {
            scales.correct(Increment { distance: 0.15, turn });
        }
        scales.keyframe(start, Pose::new(0.28, 0.0, 0.0), &Drift::NONE);
        assert_eq!(scales.correct(Increment { distance: 1.0, turn: 0.0 }).distance, 1.0);
    }

    proptest! {
        #[test]
        fn no_measurement_breaks_it(
            motions in prop::collection::vec(
                (any::<f64>(), any::<f64>(), -4.0..4.0_f64, -4.0..4.0_f64), 0..20,
            ),
        ) {
            let mut scales = WheelScales::new(WheelCalibration::TurnsAndDistances);
            for (distance, turn, ahead, heading) in motions {
                let found = scales.correct(Increment { distance, turn });
                prop_assert!(found.distance.is_finite() && found.turn.is_finite());
                let new = Pose::new(ahead, 0.0, heading);
                scales.keyframe(Pose::default(), new, &Drift::NONE);
            }
            let one = scales.correct(Increment { distance: 1.0, turn: 1.0 });
            prop_assert!((one.turn - 1.0).abs() <= MOST + 1e-12);
            prop_assert!((one.distance - 1.0).abs() <= MOST + 1e-12);
        }
    }
}
