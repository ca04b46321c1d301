//! Parts of the scores: difficulty per area and per distance, less what a world without difficulty
//! costs.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::run_summary::{RunSummary, STUCK_COLLISIONS};
use crate::policy::margins::cruising_speed;
use crate::robot::Robot;

/// Distance in metres that a robot without errors sees to either side.
const VIEW: f64 = 8.0;

/// Excess time in seconds per square metre mapped at which `e_time` is 0.5.
const HALF_TIME: f64 = 1.5;

/// Excess turning in radians per metre at which `e_turn` is 0.5.
const HALF_TURNING: f64 = 1.0;

/// Collisions per 100 m at which `e_hit` is 1 - 1/e.
const MANY_COLLISIONS: f64 = 5.0;

/// Least path length in metres that counts, since a robot that is stuck at once had few collisions.
const LEAST_DISTANCE: f64 = 20.0;

/// Least fraction of F that counts in the time per area, since an empty map took finite time.
const LEAST_COVERAGE: f64 = 0.01;

/// Error in metres relative to the pose 20 m of path before that a robot makes in a world without
/// difficulty, on a map with cells of 0.05 m.
const LEAST_DRIFT: f64 = 0.04;

/// Error in metres beyond [`LEAST_DRIFT`] at which `e_pose` is 0.5.
const HALF_DRIFT: f64 = 0.05;

/// The parts of which M and N are weighted sums, from 0 to 1. See the fields of
/// [`Scores`](super::Scores), and of [`Score1`](super::Score1) for those that differ in score 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parts {
    /// Wall error: walls out of place or missing.
    pub e_wall: f64,
    /// Usability error: paths planned on the map that fail in the world.
    pub e_use: f64,
    /// Pose error: drift of the estimated pose.
    pub e_pose: f64,
    /// Coverage error: ground that the map does not show as free.
    pub e_cov: f64,
    /// Time.
    pub e_time: f64,
    /// Collisions and robots that were stuck.
    pub e_hit: f64,
    /// Turning.
    pub e_turn: f64,
}

/// Returns the part of an error of the pose, which is given in metres.
pub(super) fn e_pose(error: f64) -> f64 {
    saturating(error - LEAST_DRIFT, HALF_DRIFT)
}

/// Saturates a value: 0 for 0, 0.5 for `half`, and towards 1 for large values.
pub(super) fn saturating(value: f64, half: f64) -> f64 {
    if value > 0.0 { value / (value + half) } else { 0.0 }
}

/// The quality of a run's map and poses.
#[derive(Clone, Copy)]
pub(super) struct Quality {
    /// Wall error: 1 - F1 at 0.30 m.
    pub(super) e_wall: f64,
    /// C, from 0 to 1.
    pub(super) coverage: f64,
    /// Error of the poses in metres, relative to the pose 20 m of path before; in score 1, the ATE.
    pub(super) pose_error: f64,
    /// Area of F in square metres.
    pub(super) free_area: f64,
    /// Fraction of paths that arrive, with the margin of one cell; in score 1, without it.
    pub(super) navigability: f64,
}

impl Parts {
    pub(super) fn of(run: &RunSummary<'_>, robot: &Robot, quality: &Quality) -> Self {
        let Quality { e_wall, coverage, pose_error, free_area, navigability } = *quality;
        let e_cov = 1.0 - coverage;
        let covered = coverage.max(LEAST_COVERAGE) * free_area;
        let open_hall = 1.0 / (2.0 * VIEW * cruising_speed(robot));
        let time = (run.time + e_cov * run.time_limit) / covered - open_hall;
        let distance = run.distance.max(LEAST_DISTANCE);
        let collisions = f64::from(run.collisions) + STUCK_COLLISIONS * f64::from(run.stuck);
        let turning = run.turning - TAU * run.tracks.len() as f64;
        Parts {
            e_wall,
            e_use: 1.0 - navigability,
            e_pose: e_pose(pose_error),
            e_cov,
            e_time: saturating(time, HALF_TIME),
            e_hit: 1.0 - libm::exp(-collisions / (distance / 100.0) / MANY_COLLISIONS),
            e_turn: saturating(turning / distance, HALF_TURNING),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::map::OccupancyMap;
    use crate::score::tests::run;
    use crate::score::{Difficulties, TrajectoryPair, Weights};

    const PERFECT: Quality = Quality {
        e_wall: 0.0,
        coverage: 1.0,
        pose_error: 0.0,
        free_area: 100.0,
        navigability: 1.0,
    };

    fn parts(run: &RunSummary<'_>, quality: &Quality) -> Parts {
        Parts::of(run, &Robot::default(), quality)
    }

    fn difficulties(run: &RunSummary<'_>, quality: &Quality) -> Difficulties {
        Weights::default().difficulties(&parts(run, quality))
    }

    #[test]
    fn a_run_without_errors_in_an_open_hall_is_without_difficulty() {
        let map = OccupancyMap::new();
        // 0.125 s/m^2 at 0.5 m/s.
        let found = difficulties(&RunSummary { time: 12.5, distance: 6.25, ..run(&map) }, &PERFECT);
        assert!(found.overall < 1e-12, "{found:?}");
    }

    #[test]
    fn each_robot_may_look_around_once() {
        let map = OccupancyMap::new();
        let tracks = [TrajectoryPair { truth: &[], estimated: &[] }; 2];
        let e_turn = |turning: f64| {
            let run = RunSummary { tracks: &tracks, turning, distance: 40.0, ..run(&map) };
            parts(&run, &PERFECT).e_turn
        };
        assert!(e_turn(2.0 * TAU) < 1e-12);
        assert!((e_turn(2.0 * TAU + 40.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn short_paths_and_empty_maps_count_as_the_documentation_says() {
        let map = OccupancyMap::new();
        let driven = |distance| {
            let run = RunSummary { distance, collisions: 1, turning: 30.0, ..run(&map) };
            let found = parts(&run, &PERFECT);
            (found.e_hit, found.e_turn)
        };
        assert_eq!(driven(0.0), driven(20.0));
        assert!(driven(20.0).0 > driven(20.1).0 && driven(20.0).1 > driven(20.1).1);
        // Of 100 m^2 at least 1 m^2 counts as covered.
        let run = RunSummary { time: 50.0, ..run(&map) };
        let time = |coverage: f64| parts(&run, &Quality { coverage, ..PERFECT }).e_time;
        let t = |coverage: f64| {
            (50.0 + (1.0 - coverage) * run.time_limit) / (100.0 * coverage.max(0.01)) - 0.125
        };
        for coverage in [0.0, 0.005, 0.01, 0.02] {
            let expected = t(coverage) / (t(coverage) + 1.5);
            assert!((time(coverage) - expected).abs() < 1e-12, "{coverage}");
        }
    }

    #[test]
    fn every_part_is_half_at_its_half_value() {
        let map = OccupancyMap::new();
        let time = 100.0 * (HALF_TIME + 0.125);
        let many = RunSummary { time, distance: 50.0, turning: 50.0, ..run(&map) };
        let half = Quality { pose_error: LEAST_DRIFT + HALF_DRIFT, ..PERFECT };
        let found = parts(&many, &half);
        for part in [found.e_time, found.e_turn, found.e_pose] {
            assert!((part - 0.5).abs() < 1e-12, "{found:?}");
        }
        let found = difficulties(&many, &half);
        assert!((found.mapping - 2.5).abs() < 1e-12 && (found.navigation - 3.75).abs() < 1e-12);
        let collisions =
            parts(&RunSummary { distance: 100.0, collisions: 2, stuck: 1, ..run(&map) }, &PERFECT);
        assert!((collisions.e_hit - (1.0 - libm::exp(-1.0))).abs() < 1e-12);
    }

    #[test]
    fn the_same_run_twice_as_large_is_as_difficult() {
        let map = OccupancyMap::new();
        let once =
            RunSummary { time: 200.0, distance: 80.0, turning: 60.0, collisions: 2, ..run(&map) };
        let twice = RunSummary {
            time: 400.0,
            time_limit: 2400.0,
            distance: 160.0,
            turning: 120.0,
            collisions: 4,
            ..once
        };
        let large = Quality { free_area: 200.0, coverage: 0.9, ..PERFECT };
        let found = difficulties(&once, &Quality { coverage: 0.9, ..PERFECT });
        assert!((found.overall - difficulties(&twice, &large).overall).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn what_is_not_covered_never_helps(
            time in 0.0..1200.0_f64, less in 0.0..1.0_f64, more in 0.0..1.0_f64,
        ) {
            let map = OccupancyMap::new();
            let run = RunSummary { time, ..run(&map) };
            let (less, more) = (less.min(more), less.max(more));
            let at = |coverage| difficulties(&run, &Quality { coverage, ..PERFECT });
            let (less, more) = (at(less), at(more));
            prop_assert!(less.navigation >= more.navigation && less.mapping >= more.mapping);
        }
    }
}
