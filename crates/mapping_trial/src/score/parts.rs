//! Score 2: difficulty by area and by distance, without what a world without difficulty costs.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::{RunSummary, STUCK_HITS, saturating};
use crate::policy::margins::cruising_speed;
use crate::robot::Robot;

/// Distance in metres up to which a robot without errors sees to either side.
const VIEW: f64 = 8.0;

/// Excess time in seconds per square metre mapped at which `e_time` is 0.5.
const HALF_TIME: f64 = 1.5;

/// Excess turning in radians per metre at which `e_turn` is 0.5.
const HALF_TURNING: f64 = 1.0;

/// Collisions per 100 m at which `e_hit` is 1 - 1/e.
const MANY_HITS: f64 = 5.0;

/// Path length in metres that counts at least: a robot that is stuck at once had few collisions.
const LEAST_DISTANCE: f64 = 20.0;

/// Least share of F in the time per area: a map of nothing took finite time.
const LEAST_COVERAGE: f64 = 0.01;

/// Error in metres relative to that 20 m of path before that a robot makes in a world without
/// difficulty, on a map with cells of 0.05 m.
const LEAST_DRIFT: f64 = 0.09;

/// Error in metres beyond it at which `e_drift` is 0.5.
const HALF_DRIFT: f64 = 0.05;

/// Weights of `e_wall`, `e_use`, `e_drift` and `e_cov` in M.
const MAPPING: [f64; 4] = [0.20, 0.20, 0.50, 0.10];

/// Weights of `e_time`, `e_cov`, `e_hit` and `e_turn` in N. Time already counts what was not covered.
const NAVIGATION: [f64; 4] = [0.40, 0.10, 0.15, 0.35];

/// Weights of M and N in D.
const OVERALL: [f64; 2] = [0.6, 0.4];

/// Difficulty by score 2.
///
/// Score 1 grows with the size of the world and saturates: its `e_time` falls once the time limit
/// binds, its `e_turn` passes its half value within minutes, an empty hall that everybody maps
/// without fault has an N above 2, and its `e_pose` depends on the moment at which a robot is lost.
/// Score 2 counts time by the area that was mapped, turning and collisions by distance, and how fast
/// the estimated pose drifts; it takes out what a robot without errors needs in an open hall of the
/// same area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score2 {
    /// D = 0.6 M + 0.4 N, from 0 to 10.
    pub difficulty: f64,
    /// M: `10 (0.20 e_wall + 0.20 e_use + 0.50 e_drift + 0.10 e_cov)`, with `e_wall` and `e_cov` of
    /// score 1.
    pub mapping: f64,
    /// N: `10 (0.40 e_time + 0.10 e_cov + 0.15 e_hit + 0.35 e_turn)`.
    pub navigation: f64,
    /// 1 - U', the share of the 40 paths on which a robot collides that is smaller all around by a
    /// cell of the map, 0.05 m: what the map cannot show does not count.
    pub e_use: f64,
    /// d / (d + 0.05 m), where d is the error of the position relative to that 20 m of path before,
    /// beyond 0.09 m; for robots that drove less, the trajectory error beyond it.
    pub e_drift: f64,
    /// t / (t + 1.5 s/m^2), where `t = (T + (1 - C) T_lim) / (C |F|) - 1 / (2 * 8 m * v)`, at least 0,
    /// with v 5/7 of the greatest speed: time by the area that was mapped, and what is not mapped
    /// never helps.
    pub e_time: f64,
    /// 1 - exp(-h / 5), where h is collisions + 3 stuck for each 100 m driven.
    pub e_hit: f64,
    /// r / (r + 1 rad/m), where r is the turning per metre beyond one look around.
    pub e_turn: f64,
}

/// What score 2 shares with score 1.
pub(super) struct Shared {
    pub(super) e_wall: f64,
    pub(super) coverage: f64,
    /// Error in metres relative to that 20 m of path before.
    pub(super) drift: f64,
    /// Area of F in square metres.
    pub(super) free_area: f64,
    /// The share of paths that arrive with the margin of a cell.
    pub(super) navigability: f64,
}

impl Score2 {
    pub(super) fn of(run: &RunSummary<'_>, robot: &Robot, shared: &Shared) -> Self {
        let Shared { e_wall, coverage, drift, free_area, navigability } = *shared;
        let (e_cov, e_use) = (1.0 - coverage, 1.0 - navigability);
        let covered = coverage.max(LEAST_COVERAGE) * free_area;
        let open_hall = 1.0 / (2.0 * VIEW * cruising_speed(robot));
        let time = (run.time + e_cov * run.time_limit) / covered - open_hall;
        let distance = run.distance.max(LEAST_DISTANCE);
        let hits = f64::from(run.hits) + STUCK_HITS * f64::from(run.stuck);
        let turning = run.turning - TAU * run.tracks.len() as f64;
        let e_drift = saturating(drift - LEAST_DRIFT, HALF_DRIFT);
        let e_time = saturating(time, HALF_TIME);
        let e_hit = 1.0 - libm::exp(-hits / (distance / 100.0) / MANY_HITS);
        let e_turn = saturating(turning / distance, HALF_TURNING);
        let sum = |weights: [f64; 4], parts: [f64; 4]| -> f64 {
            10.0 * weights.iter().zip(parts).map(|(weight, part)| weight * part).sum::<f64>()
        };
        let mapping = sum(MAPPING, [e_wall, e_use, e_drift, e_cov]);
        let navigation = sum(NAVIGATION, [e_time, e_cov, e_hit, e_turn]);
        let difficulty = OVERALL[0] * mapping + OVERALL[1] * navigation;
        Score2 { difficulty, mapping, navigation, e_use, e_drift, e_time, e_hit, e_turn }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::map::OccupancyMap;
    use crate::score::TrajectoryPair;
    use crate::score::tests::run;

    const PERFECT: Shared =
        Shared { e_wall: 0.0, coverage: 1.0, drift: 0.0, free_area: 100.0, navigability: 1.0 };

    fn score(run: &RunSummary<'_>, shared: &Shared) -> Score2 {
        Score2::of(run, &Robot::default(), shared)
    }

    #[test]
    fn a_run_without_errors_in_an_open_hall_is_without_difficulty() {
        let map = OccupancyMap::new();
        // 0.125 s/m^2 at 0.5 m/s.
        let found = score(&RunSummary { time: 12.5, distance: 6.25, ..run(&map) }, &PERFECT);
        assert!(found.difficulty < 1e-12, "{found:?}");
    }

    #[test]
    fn each_robot_may_look_around_once() {
        let map = OccupancyMap::new();
        let tracks = [TrajectoryPair { truth: &[], estimated: &[] }; 2];
        let e_turn = |turning: f64| {
            let run = RunSummary { tracks: &tracks, turning, distance: 40.0, ..run(&map) };
            score(&run, &PERFECT).e_turn
        };
        assert!(e_turn(2.0 * TAU) < 1e-12);
        assert!((e_turn(2.0 * TAU + 40.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn every_part_is_half_at_its_half_value() {
        let map = OccupancyMap::new();
        let time = 100.0 * (HALF_TIME + 0.125);
        let many = RunSummary { time, distance: 50.0, turning: 50.0, ..run(&map) };
        let found = score(&many, &Shared { drift: LEAST_DRIFT + HALF_DRIFT, ..PERFECT });
        for part in [found.e_time, found.e_turn, found.e_drift] {
            assert!((part - 0.5).abs() < 1e-12, "{found:?}");
        }
        assert!((found.mapping - 2.5).abs() < 1e-12 && (found.navigation - 3.75).abs() < 1e-12);
        let hits = score(&RunSummary { distance: 100.0, hits: 2, stuck: 1, ..run(&map) }, &PERFECT);
        assert!((hits.e_hit - (1.0 - libm::exp(-1.0))).abs() < 1e-12);
    }

    #[test]
    fn the_same_run_twice_as_large_is_as_difficult() {
        let map = OccupancyMap::new();
        let once = RunSummary { time: 200.0, distance: 80.0, turning: 60.0, hits: 2, ..run(&map) };
        let twice = RunSummary {
            time: 400.0,
            time_limit: 2400.0,
            distance: 160.0,
            turning: 120.0,
            hits: 4,
            ..once
        };
        let large = Shared { free_area: 200.0, coverage: 0.9, ..PERFECT };
        let found = score(&once, &Shared { coverage: 0.9, ..PERFECT });
        assert!((found.difficulty - score(&twice, &large).difficulty).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn what_is_not_covered_never_helps(
            time in 0.0..1200.0_f64, less in 0.0..1.0_f64, more in 0.0..1.0_f64,
        ) {
            let map = OccupancyMap::new();
            let run = RunSummary { time, ..run(&map) };
            let (less, more) = (less.min(more), less.max(more));
            let score = |coverage| score(&run, &Shared { coverage, ..PERFECT });
            let (less, more) = (score(less), score(more));
            prop_assert!(less.navigation >= more.navigation && less.mapping >= more.mapping);
        }
    }
}
