//! The result of a trial of a survey, which is a line of a file.

use envgen::Seed;
use serde::{Deserialize, Serialize};

use crate::score::Scores;
use crate::trial::EndReason;

/// The result of one trial of a survey.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Number of the world in the survey, from 0.
    pub map: u32,
    /// Number of the condition, from 0.
    pub condition: u32,
    /// Number of the noise seed, from 0.
    pub noise: u32,
    /// Seed of the world.
    pub world_seed: Seed,
    /// Seed of the sensor noise.
    pub noise_seed: Seed,
    /// Digest of the trial's log; empty if there was no trial.
    pub log_digest: String,
    /// Why the trial ended.
    pub end: Option<EndReason>,
    /// Distance in metres between the last estimated position and the true one.
    pub pose_error: f64,
    /// The scores; absent if the world could not be generated, or no trial could run in it.
    pub scores: Option<Scores>,
    /// Why there are no scores.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}
