//! Distances, speeds and times for driving, which follow from a robot's size and limits.

use std::f64::consts::PI;

use crate::backend::TICK;
use crate::lidar::LaserProfile;
use crate::robot::{PIONEER_3AT, Robot};

/// Speed in m/s at which a Pioneer 3-AT cruises on open ground. Other robots cruise at the same
/// fraction of their greatest speed.
const CRUISE: f64 = 0.5;

/// Distance in metres within which a Pioneer 3-AT that cruises can stop.
const BRAKING: f64 = 0.25;

/// Greatest number of ticks between two scans for which echoes need not be moved with the robot. In
/// this time a Pioneer 3-AT moves 10 cm or turns by 16 degrees.
const FRESH: u32 = 4;

/// The distance in metres that a cruising robot may move between two scans for the same.
const NEAR: f64 = 0.1;

/// Returns whether a laser has a long time between two scans.
fn is_slow(laser: &LaserProfile) -> bool {
    laser.ticks_a_scan > FRESH
}

/// Returns whether a robot moves so far between two scans of a laser that echoes must be moved with it.
pub(super) fn outruns(robot: &Robot, laser: &LaserProfile) -> bool {
    let moved = f64::from(laser.ticks_a_scan) * TICK * cruising_speed(robot);
    // The Pioneer moves exactly as far, but for rounding.
    is_slow(laser) || moved > NEAR + 1e-9
}

/// The limits of driving, computed once per robot. All are in metres, m/s, radians and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Margins {
    /// How many times longer than a Pioneer 3-AT the robot needs to turn around, or to creep as far; at
    /// least 1.
    pub(super) slowness: f64,
    /// Speed on open ground.
    pub(super) cruise: f64,
    /// Speed at which the robot drives where it may soon have to brake: as on open ground, but at most the speed from
    /// which it can stop within the same distance as a Pioneer 3-AT.
    pub(super) steady: f64,
    /// Speed at which the robot drives around obstacles that are not on the map.
    pub(super) creep: f64,
    /// Distance ahead on the path that the robot drives towards.
    pub(super) lookahead: f64,
    /// Radius around its centre within which a robot does not look for frontiers: its own body.
    pub(super) feet: f64,
    /// Distance between the centres of two robots at which one waits for the other.
    pub(super) meeting: f64,
    /// Angle of the first turn, after which the laser has seen all around, and the time after which
    /// this turn ends in any case.
    pub(super) survey: (f64, f64),
    /// Greatest turn rate of that turn, and the time for which the robot waits after it for a scan of where it turned
    /// to, for lasers with long times between scans.
    pub(super) slow_survey: Option<(f64, f64)>,
    /// Time for which the robot looks at an unknown place before it gives up: two scans and the map.
    pub(super) look: f64,
    /// Least mean speed on a path. A slower robot gives the path up.
    pub(super) slowest: f64,
    /// Distance and time: a robot that moves less than this distance within this time is stuck.
    pub(super) stuck: (f64, f64),
    /// Distance and speed of backing off.
    pub(super) back_off: (f64, f64),
    /// Radius of a keepout zone where the robot got stuck, and its distance ahead of the robot's centre.
    pub(super) obstruction: (f64, f64),
}

/// Speed in m/s at which a robot cruises on open ground.
pub(crate) fn cruising_speed(robot: &Robot) -> f64 {
    // 5 / 7, in the order of operations that gives the Pioneer exactly 0.5.
    robot.max_speed * (CRUISE * 10.0) / (PIONEER_3AT.max_speed * 10.0)
}

/// Time in seconds that a robot needs to turn around from standstill to standstill.
fn turning_around(robot: &Robot) -> f64 {
    let Robot { max_turn_rate: rate, turn_acceleration: acceleration, .. } = *robot;
    match rate * rate / acceleration < PI {
        true => PI / rate + rate / acceleration,
        false => 2.0 * (PI / acceleration).sqrt(),
    }
}

impl Margins {
    pub(super) fn of(robot: &Robot, laser: &LaserProfile) -> Self {
        let larger = robot.circumscribed_radius - PIONEER_3AT.circumscribed_radius;
        let cruise = cruising_speed(robot);
        let slow = 0.15_f64.min(robot.max_speed);
        let turns = (turning_around(robot) / turning_around(&PIONEER_3AT)).max(1.0);
        let slowness = turns.max(0.15 / slow);
        let turn = (1.1 * PI + (PI - laser.field_of_view)).max(0.1 * PI);
        let period = f64::from(laser.ticks_a_scan) * TICK;
        let look = (2.5 * period).max(0.6);
        // Scans overlap, unless the turn would take more than a minute.
        let overlapping = (0.8 * laser.field_of_view / period).max(turn / 60.0);
        let survey_rate = overlapping.min(robot.max_turn_rate);
        Margins {
            slowness,
            cruise,
            steady: cruise.min((2.0 * robot.acceleration * BRAKING).sqrt()),
            creep: slow,
            lookahead: (1.2 * cruise).max(0.6),
            feet: 0.4 + larger,
            meeting: 1.4 + 2.0 * larger,
            survey: (turn, (3.0 * turn / survey_rate).max(10.0 * slowness)),
            slow_survey: is_slow(laser).then_some((survey_rate, look)),
            look,
            slowest: 0.2 * cruise / turns,
            stuck: ((0.1 * 5.0 * cruise).min(0.1), 5.0 * turns),
            back_off: (0.3, slow),
            obstruction: (0.25, 0.2 + larger.max(0.0)),
        }
    }

    /// Returns when a task ends at the latest for which a Pioneer 3-AT would have so many seconds from
    /// now.
    pub(super) fn limit(&self, now: f64, seconds: f64) -> f64 {
        now + seconds * self.slowness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_robots_and_slow_lasers_need_echoes_that_move() {
        let laser = LaserProfile::default();
        let slow = LaserProfile { ticks_a_scan: FRESH + 1, ..laser.clone() };
        let quick = LaserProfile { ticks_a_scan: 1, ..laser.clone() };
        let at = |max_speed| Robot { max_speed, ..PIONEER_3AT };
        for (robot, laser, expected) in [
            (PIONEER_3AT, &laser, false),
            (PIONEER_3AT, &slow, true),
            (at(0.26), &laser, false),
            (at(0.75), &laser, true),
            (at(2.0), &laser, true),
            (at(2.0), &quick, false),
        ] {
            assert_eq!(outruns(&robot, laser), expected, "{} m/s", robot.max_speed);
        }
    }

    #[test]
    fn the_pioneer_drives_as_it_always_did() {
        let margins = Margins::of(&PIONEER_3AT, &LaserProfile::default());
        let expected = Margins {
            slowness: 1.0,
            cruise: 0.5,
            steady: 0.5,
            creep: 0.15,
            lookahead: 0.6,
            feet: 0.4,
            meeting: 1.4,
            survey: (1.1 * PI, 10.0),
            slow_survey: None,
            look: 0.6,
            slowest: 0.1,
            stuck: (0.1, 5.0),
            back_off: (0.3, 0.15),
            obstruction: (0.25, 0.2),
        };
        assert_eq!(margins, expected);
    }

    #[test]
    fn slow_robots_are_not_stuck_because_they_are_slow() {
        let robot = Robot { max_speed: 0.05, max_turn_rate: 0.1, ..PIONEER_3AT };
        let margins = Margins::of(&robot, &LaserProfile::default());
        assert!(margins.cruise <= robot.max_speed && margins.creep <= robot.max_speed);
        assert!(margins.stuck.0 < 0.5 * margins.cruise * margins.stuck.1);
        assert!(margins.survey.1 > margins.survey.0 / robot.max_turn_rate);
        // It turns around on the spot in 32 s, a Pioneer in 3.2 s.
        assert!((9.0..11.0).contains(&margins.slowness), "{margins:?}");
        assert!(margins.stuck.1 > 0.3 * 32.0 && margins.slowest < 0.01, "{margins:?}");
        let robot = Robot { turn_acceleration: 0.02, ..PIONEER_3AT };
        let margins = Margins::of(&robot, &LaserProfile::default());
        assert!((7.0..9.0).contains(&margins.slowness), "{margins:?}");
    }

    #[test]
    fn scans_overlap_while_a_robot_looks_all_around() {
        for (ticks_a_scan, field_of_view) in
            [(5, PI), (100, PI), (200, PI), (200, 0.5 * PI), (200, 0.0)]
        {
            let laser = LaserProfile { ticks_a_scan, field_of_view, ..LaserProfile::default() };
            let Margins { survey: (turn, until), slow_survey, look, .. } =
                Margins::of(&PIONEER_3AT, &laser);
            let (rate, wait) = slow_survey.expect("a slow laser");
            let period = f64::from(ticks_a_scan) * TICK;
            let (overlaps, takes_long) = (rate * period < field_of_view, turn / rate > 59.0);
            assert!(overlaps || takes_long, "{laser:?}: {rate}");
            assert!(turn / rate < 61.0 && until > turn / rate, "{laser:?}: {rate}, {until}");
            assert!(wait == look && wait > 2.0 * period, "{laser:?}: {wait}");
            assert!(rate <= PIONEER_3AT.max_turn_rate);
        }
    }

    #[test]
    fn a_laser_that_sees_all_around_hardly_turns() {
        let laser = LaserProfile { field_of_view: 2.0 * PI, ..LaserProfile::default() };
        let Margins { survey: (turn, _), .. } = Margins::of(&PIONEER_3AT, &laser);
        assert!(turn < 0.4, "{turn}");
        let narrow = LaserProfile { field_of_view: 0.5 * PI, ..LaserProfile::default() };
        let Margins { survey: (turn, _), .. } = Margins::of(&PIONEER_3AT, &narrow);
        assert!(turn > 1.5 * PI, "{turn}");
    }
}
