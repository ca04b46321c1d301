//! Score 1, the older of the two scores, which takes a trial as a whole and not per area and distance.

use serde::{Deserialize, Serialize};

use super::parts::{Parts, Quality, saturating};
use super::run_summary::{RunSummary, STUCK_COLLISIONS};
use super::weights::Weights;

/// Trajectory error in metres at which `e_pose` is 0.5.
const HALF_ERROR: f64 = 0.5;

/// Time in seconds per square metre of ground at which `e_time` is 0.5.
const HALF_TIME: f64 = 1.5;

/// Number of collisions at which `e_hit` is 1 - 1/e.
const MANY_COLLISIONS: f64 = 5.0;

/// Turning in radians at which `e_turn` is 0.5.
const HALF_TURNING: f64 = 60.0;

/// Difficulty by score 1, in which reports before version 2 give D, M and N.
///
/// It grows with the size of the world, and saturates: `e_time` falls once the time limit binds,
/// `e_turn` passes half its range within minutes, an empty hall that everybody maps without error has
/// an N above 2, and `e_pose` depends on the moment at which a robot gets lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score1 {
    /// D = 0.6 M + 0.4 N, from 0 to 10.
    pub difficulty: f64,
    /// M: `10 (0.35 e_wall + 0.30 e_use + 0.25 e_pose + 0.10 e_cov)`, with `e_wall` and `e_cov` of
    /// [`Scores`](super::Scores).
    pub mapping: f64,
    /// N: `10 (0.40 e_time + 0.25 e_cov + 0.20 e_hit + 0.15 e_turn)`.
    pub navigation: f64,
    /// Usability error: 1 - U.
    pub e_use: f64,
    /// Pose error: ATE / (ATE + 0.5 m).
    pub e_pose: f64,
    /// Time: T / (T + T0), with T0 = 1.5 s for each square metre of F.
    pub e_time: f64,
    /// Collisions: 1 - exp(-(collisions + 3 stuck) / 5).
    pub e_hit: f64,
    /// Turning: turning / (turning + 60 rad).
    pub e_turn: f64,
}

impl Score1 {
    /// Scores a run whose `quality` has ATE and U.
    pub(super) fn of(run: &RunSummary<'_>, quality: &Quality) -> Self {
        let Quality { e_wall, coverage, pose_error, free_area, navigability } = *quality;
        let collisions = f64::from(run.collisions) + STUCK_COLLISIONS * f64::from(run.stuck);
        let parts = Parts {
            e_wall,
            e_use: 1.0 - navigability,
            e_pose: saturating(pose_error, HALF_ERROR),
            e_cov: 1.0 - coverage,
            e_time: saturating(run.time, HALF_TIME * free_area),
            e_hit: 1.0 - libm::exp(-collisions / MANY_COLLISIONS),
            e_turn: saturating(run.turning, HALF_TURNING),
        };
        let difficulties = Weights::SCORE_1.difficulties(&parts);
        Score1 {
            difficulty: difficulties.overall,
            mapping: difficulties.mapping,
            navigation: difficulties.navigation,
            e_use: parts.e_use,
            e_pose: parts.e_pose,
            e_time: parts.e_time,
            e_hit: parts.e_hit,
            e_turn: parts.e_turn,
        }
    }
}
