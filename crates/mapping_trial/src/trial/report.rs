//! The report of a trial, as it is written to a file.

use envgen::calibration::Dials;
use envgen::scenario::Scenario;
use envgen::{Provenance, World};
use serde::{Deserialize, Serialize};

use super::end::EndReason;
use super::parts::{ForeignPart, PartRole};
use super::running::Trial;
use super::settings::TrialSettings;
use crate::backend::{RobotBackend, TICK};
use crate::feedback::{Feedback, Measured, Rating, Session};
use crate::names::Named;
use crate::score::{Reference, ScoreError, Scores};

/// Version of the reports' layout.
pub const REPORT_VERSION: u32 = 2;

/// The report of a trial: its world, its settings, and its scores.
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
    /// The settings of the trial.
    pub settings: TrialSettings,
    /// What each robot did.
    pub robots: Vec<RobotReport>,
    /// The doors, people and smoke; absent where nothing moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// The parts that were plugged in, in place of those that the settings name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foreign: Vec<ForeignPart>,
    /// Why the policy failed; absent if it did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// The scores: how well the world was mapped, and how difficult that was.
    pub scores: Scores,
    /// The form of Zwennes (2011), appendix B, as filled by the operator; `None` until a person fills it.
    pub feedback: Option<Feedback>,
}

impl TrialReport {
    /// The answers to the form's questions about the session, as far as the report knows them.
    pub fn session(&self) -> Session {
        Session::new(&self.world.name(), self.robots.len(), &self.settings.body)
    }

    /// Whether the ratings of its form are its own scores D, M and N, as they are where a program drove and nobody filled
    /// the form.
    pub fn is_form_measured(&self) -> bool {
        let Scores { difficulty, mapping, navigation, .. } = self.scores;
        let scores = Dials { difficulty, mapping, navigation };
        self.feedback.as_ref().is_some_and(|form| form.ratings().map(Rating::value) == scores)
    }
}

/// What one robot did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotReport {
    /// Why its part ended; `None` if it had not ended.
    pub end: Option<EndReason>,
    /// Simulated seconds until then.
    pub time: f64,
    /// Path length in metres.
    pub distance: f64,
    /// Turning in radians, left and right added.
    pub turning: f64,
    /// Number of collisions, `hits` in files.
    #[serde(rename = "hits")]
    pub collisions: u32,
    /// Number of recoveries.
    pub recoveries: u32,
    /// Distance in metres of the last estimated position from the true one.
    #[serde(default)]
    pub pose_error: f64,
}

impl<B: RobotBackend> Trial<B> {
    /// The report of the trial so far, with the form filled from measurements if a policy drove.
    ///
    /// # Errors
    ///
    /// As [`Trial::score`].
    pub fn report(&self, world: &World, truth: &Reference) -> Result<TrialReport, ScoreError> {
        let robot = |robot: usize| RobotReport {
            end: self.end_of(robot).map(|end| end.reason),
            time: self.end_of(robot).map_or(self.time(), |end| end.tick as f64 * TICK),
            distance: self.trajectory(robot).distance,
            turning: self.trajectory(robot).turning,
            collisions: self.bodies().collisions(robot),
            recoveries: self.recoveries(robot),
            pose_error: self.pose_error(robot),
        };
        let estimated = self.estimated_tracks()?;
        let scores = self.score_of(truth, &estimated)?;
        let part = |role| self.foreign().iter().find(|part| part.role == role);
        let mut report = TrialReport {
            version: REPORT_VERSION,
            world: world.provenance.clone(),
            world_digest: world.digest().to_string(),
            log_digest: self.log().digest().to_string(),
            settings: self.settings().clone(),
            robots: (0..self.robots()).map(robot).collect(),
            scenario: self.scenario().cloned(),
            foreign: self.foreign().to_vec(),
            failure: self.failure().map(str::to_owned),
            scores,
            feedback: None,
        };
        let built_in = self.settings().policy.as_ref().and_then(Named::name);
        let plugged_in = part(PartRole::Policy).map(|part| part.name.as_str());
        if let Some(policy) = plugged_in.or(built_in) {
            let tracks = self.score_tracks(&estimated);
            let measured = Measured { policy, world, scores: &scores, tracks: &tracks };
            // Scores are ratings from 0 to 10.
            report.feedback = measured.fill(&report.session()).ok();
        }
        Ok(report)
    }
}
