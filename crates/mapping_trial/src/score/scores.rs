//! The scores of a run: every component, and M, N and D.

use serde::{Deserialize, Serialize};

use super::error::ScoreError;
use super::map_scores::{MapScores, TOLERANCES, TrajectoryScores};
use super::parts::{Parts, Quality};
use super::pose;
use super::raster::Raster;
use super::reference::Reference;
use super::run_summary::{RunSummary, check};
use super::score_1::Score1;
use super::swept::SweptCells;
use super::weights::{Difficulties, Weights};
use crate::mappable_area::SCORE_CELL;

/// The scores of a run that concern people and doors.
///
/// A map is neither right nor wrong where one of them was for more than a twentieth of the time. These
/// cells count in no precision and no recall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovingScores {
    /// Number of collisions with people. Its name in files is `person_hits`.
    #[serde(rename = "person_hits")]
    pub person_collisions: u32,
    /// Area in square metres where people and door leaves were for more than a twentieth of the time.
    pub swept_area: f64,
    /// Part of that area, in square metres, that the map shows as occupied although no true wall is
    /// within 0.15 m: ghosts of people, and door leaves.
    pub ghost_area: f64,
}

/// The scores of a run.
///
/// Fractions and errors `e_...` are from 0 to 1. M, N and D are from 0 to 10, where 10 is the most
/// difficult. F is the ground that the robot can cover, in cells of 0.1 m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scores {
    /// D = 0.6 M + 0.4 N: overall difficulty.
    pub difficulty: f64,
    /// M: difficulty of mapping, `10 (0.20 e_wall + 0.20 e_use + 0.50 e_pose + 0.10 e_cov)`.
    pub mapping: f64,
    /// N: difficulty of navigation,
    /// `10 (0.40 e_time + 0.10 e_cov + 0.15 e_hit + 0.35 e_turn)`.
    pub navigation: f64,
    /// Wall error: 1 - F1 at 0.30 m.
    pub e_wall: f64,
    /// Usability error: 1 - U', the fraction of the 40 paths that fail for a robot that is smaller all
    /// around by a cell of the map, 0.05 m. What the map cannot show does not count.
    pub e_use: f64,
    /// Pose error: d / (d + 0.05 m), where d is the error of the position relative to the pose 20 m of
    /// path before, beyond 0.04 m, at poses every 0.25 m of path. Robots that drove less count with their
    /// absolute errors.
    pub e_pose: f64,
    /// Coverage error: 1 - C.
    pub e_cov: f64,
    /// Time: t / (t + 1.5 s/m^2), where `t = (T + (1 - C) T_lim) / (C |F|) - 1 / (2 * 8 m * v)`, at
    /// least 0, with v 5/7 of the greatest speed. `T_lim` is the time limit, or how long the battery lasts
    /// if that is less. This is the time per mapped area, beyond what a robot without errors needs in an
    /// open hall. In the divisor C counts as at least 0.01. In the same time, mapping less never helps.
    pub e_time: f64,
    /// Collisions: 1 - exp(-h / 5), where h is (collisions + 3 stuck) per 100 m driven. The distance
    /// counts as at least 20 m.
    pub e_hit: f64,
    /// Turning: r / (r + 1 rad/m), where r is the turning per metre beyond one look around of each
    /// robot. The distance counts as at least 20 m.
    pub e_turn: f64,
    /// C: fraction of F that the map shows as free.
    pub coverage: f64,
    /// Fraction of the map's occupied cells that are within 0.30 m of a wall that can be seen from F.
    pub precision_30: f64,
    /// Fraction of those walls that are within 0.30 m of an occupied cell of the map.
    pub recall_30: f64,
    /// Harmonic mean of precision and recall within 0.30 m.
    pub f1_30: f64,
    /// Precision within 0.15 m.
    pub precision_15: f64,
    /// Recall within 0.15 m.
    pub recall_15: f64,
    /// Harmonic mean of precision and recall within 0.15 m.
    pub f1_15: f64,
    /// Mean distance in metres from the map's walls to the true ones and back, each at most 1 m.
    pub wall_distance: f64,
    /// Fraction of the walls that the map shows twice, within 0.7 m to either side.
    pub ghosting: f64,
    /// U: fraction of 40 paths, planned on the map and driven in the true world, that arrive without a
    /// collision.
    pub navigability: f64,
    /// Absolute trajectory error (ATE): root mean square of the position errors in metres over all
    /// ticks, without alignment.
    pub trajectory_error: f64,
    /// Root mean square error in metres of the position relative to the pose 1 m of path before; absent
    /// if no robot drove that far.
    pub relative_error_near: Option<f64>,
    /// Root mean square error in radians of the heading relative to that pose.
    pub relative_turn_near: Option<f64>,
    /// Root mean square error in metres of the position relative to the pose 20 m of path before;
    /// absent if no robot drove that far.
    pub relative_error_far: Option<f64>,
    /// Root mean square error in radians of the heading relative to that pose.
    pub relative_turn_far: Option<f64>,
    /// Area of F in square metres.
    pub free_area: f64,
    /// Simulated time in seconds.
    pub time: f64,
    /// Path length of all robots in metres.
    pub distance: f64,
    /// Turning of all robots in radians.
    pub turning: f64,
    /// Number of collisions of all robots. Its name in files is `hits`.
    #[serde(rename = "hits")]
    pub collisions: u32,
    /// Number of recoveries of all robots.
    pub recoveries: u32,
    /// Number of robots that were stuck for good, or lost in water.
    pub stuck: u32,
    /// Least time in seconds, over all robots, for which the battery would still have lasted.
    pub energy_left: f64,
    /// Scores of the same run by the older score, for comparison with the thesis.
    pub score_1: Score1,
    /// Scores that concern people and doors; absent if nothing moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<MovingScores>,
}

impl Scores {
    /// Scores a run against the mappable area of its world.
    ///
    /// # Errors
    /// If a trajectory's lists differ in length, or a number is not finite or negative.
    pub fn of(truth: &Reference, run: &RunSummary<'_>) -> Result<Scores, ScoreError> {
        check(run)?;
        let raster = Raster::of(truth, run.map);
        let swept = run.moving.map(|(swept, _)| swept);
        let map = MapScores::of_raster(truth, run.map, &raster, swept);
        let drift = pose::drift(run.tracks);
        let poses = TrajectoryScores::of_checked(run.tracks, drift);
        let quality = Quality {
            e_wall: map.e_wall,
            coverage: map.coverage,
            pose_error: drift,
            free_area: map.free_area,
            navigability: 1.0 - map.e_use,
        };
        let parts = Parts::of(run, truth.robot(), &quality);
        let as_a_whole = Quality {
            pose_error: poses.trajectory_error,
            navigability: map.navigability,
            ..quality
        };
        let score_1 = Score1::of(run, &as_a_whole);
        let Difficulties { mapping, navigation, overall } = Weights::default().difficulties(&parts);
        let Parts { e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn } = parts;
        Ok(Scores {
            difficulty: overall,
            mapping,
            navigation,
            e_wall,
            e_use,
            e_pose,
            e_cov,
            e_time,
            e_hit,
            e_turn,
            coverage: map.coverage,
            precision_30: map.precision_30,
            recall_30: map.recall_30,
            f1_30: map.f1_30,
            precision_15: map.precision_15,
            recall_15: map.recall_15,
            f1_15: map.f1_15,
            wall_distance: map.wall_distance,
            ghosting: map.ghosting,
            navigability: map.navigability,
            trajectory_error: poses.trajectory_error,
            relative_error_near: poses.relative_error_near,
            relative_turn_near: poses.relative_turn_near,
            relative_error_far: poses.relative_error_far,
            relative_turn_far: poses.relative_turn_far,
            free_area: map.free_area,
            time: run.time,
            distance: run.distance,
            turning: run.turning,
            collisions: run.collisions,
            recoveries: run.recoveries,
            stuck: run.stuck,
            energy_left: run.energy_left,
            score_1,
            moving: run.moving.map(|(swept, person_collisions)| MovingScores {
                person_collisions,
                swept_area: swept.area(),
                ghost_area: ghost_area(truth, &raster, swept),
            }),
        })
    }

    /// Returns the parts of which M and N consist.
    pub fn parts(&self) -> Parts {
        let Scores { e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn, .. } = *self;
        Parts { e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn }
    }
}

/// Area in square metres that the map shows as occupied where people or door leaves were, and no true wall is within
/// the tolerance of the stricter precision.
fn ghost_area(truth: &Reference, raster: &Raster, swept: &SweptCells) -> f64 {
    let [_, tolerance] = TOLERANCES.map(|metres| metres / SCORE_CELL);
    let occupied = raster.occupied.iter().enumerate().filter(|(_, occupied)| **occupied);
    let ghosts = occupied.filter(|(cell, _)| {
        let (col, row) = raster.frame.place(*cell);
        let squared = truth.frame().cell(col, row).map(|cell| truth.wall_distance()[cell]);
        let is_wall = squared.is_some_and(|squared| f64::from(squared) <= tolerance * tolerance);
        swept.is_moving(col, row) && !is_wall
    });
    ghosts.count() as f64 * SCORE_CELL * SCORE_CELL
}
