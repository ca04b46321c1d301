//! Score 2: difficulty as the excess over what a robot without errors needs in the same world.

use serde::{Deserialize, Serialize};

use super::{RunSummary, STUCK_HITS, Tour, saturating};

/// Excess time in seconds per square metre mapped at which `e_time` is 0.5.
const HALF_TIME: f64 = 1.5;

/// Excess turning in radians per metre at which `e_turn` is 0.5.
const HALF_TURNING: f64 = 0.5;

/// Collisions per 100 m at which `e_hit` is 1 - 1/e.
const MANY_HITS: f64 = 5.0;

/// Path length in metres that counts at least: a robot that is stuck at once had few collisions.
const LEAST_DISTANCE: f64 = 20.0;

/// Least share of F in the time per area: a map of nothing took finite time.
const LEAST_COVERAGE: f64 = 0.01;

/// Weights of `e_wall`, `e_use`, `e_pose` and `e_cov` in M.
const MAPPING: [f64; 4] = [0.35, 0.30, 0.25, 0.10];

/// Weights of `e_time`, `e_cov`, `e_hit` and `e_turn` in N. Time already counts what was not covered.
const NAVIGATION: [f64; 4] = [0.45, 0.15, 0.25, 0.15];

/// Weights of M and N in D.
const OVERALL: [f64; 2] = [0.6, 0.4];

/// Difficulty by score 2.
///
/// Score 1 grows with the size of the world and saturates: its `e_time` falls once the time limit
/// binds, its `e_turn` passes its half value within minutes, and an empty hall that everybody maps
/// without fault has an N above 2. Score 2 counts time by the area that was mapped, turning and
/// collisions by distance, and takes out the [`Tour`] of a robot without errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score2 {
    /// D = 0.6 M + 0.4 N, from 0 to 10.
    pub difficulty: f64,
    /// M: `10 (0.35 e_wall + 0.30 e_use + 0.25 e_pose + 0.10 e_cov)`, with `e_wall`, `e_pose` and
    /// `e_cov` of score 1.
    pub mapping: f64,
    /// N: `10 (0.45 e_time + 0.15 e_cov + 0.25 e_hit + 0.15 e_turn)`.
    pub navigation: f64,
    /// 1 - U', the share of the 40 paths on which a robot collides that is smaller all around by a
    /// cell of the map, 0.05 m: what the map cannot show does not count.
    pub e_use: f64,
    /// t / (t + 1.5 s/m^2), where `t = (T + (1 - C) T_lim) / (C |F|) - T_tour / |F|`, at least 0.
    pub e_time: f64,
    /// 1 - exp(-h / 5), where h is collisions + 3 stuck for each 100 m driven.
    pub e_hit: f64,
    /// r / (r + 0.5 rad/m), where r is the turning per metre beyond the tour's, at least 0.
    pub e_turn: f64,
}

/// What score 2 shares with score 1.
pub(super) struct Shared {
    pub(super) e_wall: f64,
    pub(super) e_pose: f64,
    pub(super) coverage: f64,
    /// Area of F in square metres.
    pub(super) free_area: f64,
    /// The share of paths that arrive with the margin of a cell.
    pub(super) navigability: f64,
}

impl Score2 {
    pub(super) fn of(run: &RunSummary<'_>, tour: Tour, shared: &Shared) -> Self {
        let Shared { e_wall, e_pose, coverage, free_area, navigability } = *shared;
        let (e_cov, e_use) = (1.0 - coverage, 1.0 - navigability);
        let covered = coverage.max(LEAST_COVERAGE) * free_area;
        let time = (run.time + e_cov * run.time_limit) / covered - tour.time / free_area;
        let distance = run.distance.max(LEAST_DISTANCE);
        let hits = f64::from(run.hits) + STUCK_HITS * f64::from(run.stuck);
        let turning = run.turning / distance - tour.turning / tour.distance.max(LEAST_DISTANCE);
        let e_time = saturating(time, HALF_TIME);
        let e_hit = 1.0 - libm::exp(-hits / (distance / 100.0) / MANY_HITS);
        let e_turn = saturating(turning, HALF_TURNING);
        let sum = |weights: [f64; 4], parts: [f64; 4]| -> f64 {
            10.0 * weights.iter().zip(parts).map(|(weight, part)| weight * part).sum::<f64>()
        };
        let mapping = sum(MAPPING, [e_wall, e_use, e_pose, e_cov]);
        let navigation = sum(NAVIGATION, [e_time, e_cov, e_hit, e_turn]);
        let difficulty = OVERALL[0] * mapping + OVERALL[1] * navigation;
        Score2 { difficulty, mapping, navigation, e_use, e_time, e_hit, e_turn }
    }
}
