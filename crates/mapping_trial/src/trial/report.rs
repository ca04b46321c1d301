//! What came of a trial, as it is written to a file.

use envgen::{Provenance, World};
use serde::{Deserialize, Serialize};

use super::{EndReason, Trial, TrialSettings};
use crate::body::{Bodies, TICK};
use crate::score::{ScoreError, Scores};
use crate::truth::Truth;

/// Version of the reports' layout.
pub const REPORT_VERSION: u32 = 1;

/// What came of a trial: where it was, what it was made of, and its scores.
///
/// It holds no wall time: the same trial gives the same report to the last byte.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialReport {
    /// [`REPORT_VERSION`].
    pub version: u32,
    /// Where the world comes from.
    pub world: Provenance,
    /// Digest of the world's geometry.
    pub world_digest: String,
    /// Digest of the trial's log.
    pub log_digest: String,
    /// What the trial was made of.
    pub settings: TrialSettings,
    /// What each robot did.
    pub robots: Vec<RobotReport>,
    /// How well the world was mapped, and how difficult that was.
    pub scores: Scores,
}

/// What one robot did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotReport {
    /// Why its part ended; `None` when it was still under way.
    pub end: Option<EndReason>,
    /// Simulated seconds until then.
    pub time: f64,
    /// Way in metres.
    pub distance: f64,
    /// Turning in radians, both ways added.
    pub turning: f64,
    /// How often it ran into something.
    pub hits: u32,
    /// How often it had to be freed.
    pub recoveries: u32,
}

impl<B: Bodies> Trial<B> {
    /// What came of the trial so far. `engine` names what moves the bodies.
    ///
    /// # Errors
    ///
    /// As [`Trial::score`].
    pub fn report(
        &self,
        world: &World,
        truth: &Truth,
        engine: &str,
    ) -> Result<TrialReport, ScoreError> {
        let robot = |robot: usize| RobotReport {
            end: self.end_of(robot).map(|end| end.reason),
            time: self.end_of(robot).map_or(self.time(), |end| end.tick as f64 * TICK),
            distance: self.track(robot).metres,
            turning: self.track(robot).turning,
            hits: self.bodies().hits(robot),
            recoveries: self.recoveries(robot),
        };
        Ok(TrialReport {
            version: REPORT_VERSION,
            world: world.provenance.clone(),
            world_digest: world.digest().to_string(),
            log_digest: self.log(engine).digest().to_string(),
            settings: self.settings().clone(),
            robots: (0..self.robots()).map(robot).collect(),
            scores: self.score(truth)?,
        })
    }
}
