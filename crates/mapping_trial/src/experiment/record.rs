//! The result of a trial, which is a line of a file.

use envgen::Blueprint;
use envgen::Seed;
use envgen::indoor::{FloorPlan, IndoorMetrics};
use serde::{Deserialize, Serialize};

use super::design::TrialId;
use crate::score::Scores;
use crate::trial::{EndReason, LOST};

/// The result of one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Identity of the trial.
    pub trial: TrialId,
    /// Seed of the map.
    pub world_seed: Seed,
    /// Seed of the sensor noise.
    pub noise_seed: Seed,
    /// Digest of the map's geometry.
    pub world_digest: String,
    /// Digest of the trial's log.
    pub log_digest: String,
    /// Why the trial ended; `None` if it was interrupted.
    pub end: Option<EndReason>,
    /// Distance in metres between the last estimated position and the true one; absent in records of
    /// earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose_error: Option<f64>,
    /// The features of the map, which the generator's rules control.
    pub features: MapFeatures,
    /// The scores: how well the map was mapped, and how difficult that was.
    pub scores: Scores,
}

impl Record {
    /// Whether both are results of the same trial. A record of an earlier version may lack the error of
    /// the last pose.
    pub(super) fn agrees_with(&self, other: &Record) -> bool {
        let known = self.pose_error.and(other.pose_error);
        let pose_error = known.and(self.pose_error);
        Record { pose_error, ..self.clone() } == Record { pose_error: known, ..other.clone() }
    }

    /// Returns in words why the trial ended, and whether the robot was lost.
    pub(super) fn end_text(&self) -> String {
        let text = self.end.map_or("–", EndReason::text);
        match self.pose_error {
            Some(error) if error > LOST => format!("{text}, lost: {error:.1} m off"),
            _ => text.to_owned(),
        }
    }
}

/// The features of a map that the five rules of Zwennes (2011) control.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapFeatures {
    /// Mean distance between hallways in cells, over both directions.
    pub hallway_spacing: f64,
    /// Open area as a fraction of the floor, without solid cells.
    pub open_share: f64,
    /// Mean number of doorways per side of a room, as drawn.
    pub doorways_a_side: f64,
    /// Mean difficulty of the rooms; `None` without rooms.
    pub room_difficulty: Option<f64>,
    /// 1 if hallway cycles were cut off, 0 if not.
    pub cycles_prevented: f64,
    /// Number of independent cycles of the hallways.
    pub hallway_cycles: f64,
    /// Number of floor cells that can be reached from only one neighbouring floor cell.
    pub dead_ends: f64,
    /// Number of rooms.
    pub rooms: f64,
    /// Number of rooms without a passable doorway.
    pub rooms_closed: f64,
}

impl MapFeatures {
    /// Returns the features of a plan.
    pub fn of(plan: &FloorPlan) -> Self {
        let metrics: IndoorMetrics = plan.metrics();
        let spacing = plan.draws().map_or([0; 2], |draws| draws.spacing);
        let share = |part: u64, whole: u64| part as f64 / whole.max(1) as f64;
        let cells = metrics.cells;
        MapFeatures {
            hallway_spacing: 0.5 * (f64::from(spacing[0]) + f64::from(spacing[1])),
            open_share: share(cells.open, cells.open + cells.hallway + cells.room),
            doorways_a_side: share(metrics.doorways, metrics.sides),
            room_difficulty: metrics.room_difficulty_mean,
            cycles_prevented: plan.draws().map_or(0.0, |d| f64::from(u8::from(d.cycles_prevented))),
            hallway_cycles: metrics.hallway_cycles as f64,
            dead_ends: metrics.dead_ends as f64,
            rooms: metrics.rooms as f64,
            rooms_closed: metrics.rooms_closed as f64,
        }
    }
}
