//! The report of a trial, which is written to a file.

use envgen::calibration::Dials;
use envgen::scenario::Scenario;
use envgen::{Provenance, World};
use serde::{Deserialize, Serialize};
use thiserror::Error;

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
/// It holds no wall-clock time, so that the same trial gives the same report to the last byte.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialReport {
    /// Version of the layout, which is [`REPORT_VERSION`].
    pub version: u32,
    /// The provenance of the world.
    pub world: Provenance,
    /// Digest of the world's geometry.
    pub world_digest: String,
    /// Digest of the trial's log.
    pub log_digest: String,
    /// The settings of the trial.
    pub settings: TrialSettings,
    /// The results of each robot.
    pub robots: Vec<RobotReport>,
    /// The doors, people and smoke; absent if nothing moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Scenario>,
    /// The parts that were plugged in, in place of those that the settings name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foreign: Vec<ForeignPart>,
    /// Parts of a replayed log that were not plugged in again: these results are those of the parts that
    /// the settings name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub replaced: Vec<ForeignPart>,
    /// Why the policy, or the driver that also does SLAM, failed; absent if it did not fail. After a failure in the
    /// last tick the ends have other reasons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// The scores: the quality of the map, and the difficulty of the world.
    pub scores: Scores,
    /// The form of Zwennes (2011), appendix B: filled by the operator, or from measurements if a policy
    /// drove; `None` if nobody has filled it.
    pub feedback: Option<Feedback>,
}

/// The reasons why a report could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The text is not a report.
    #[error("this is not the report of a trial: {0}")]
    Json(#[from] serde_json::Error),
    /// The report has another version.
    #[error("a report of version {found}, expected version {REPORT_VERSION}")]
    Version {
        /// The version of the report.
        found: u64,
    },
}

impl TrialReport {
    /// Reads a report.
    ///
    /// # Errors
    ///
    /// If the text is not a report, or if it is of another version.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        /// A report of another version has other fields.
        #[derive(Deserialize)]
        struct AnyVersion {
            version: u64,
        }
        match serde_json::from_str(text) {
            Ok(AnyVersion { version }) if version != u64::from(REPORT_VERSION) => {
                Err(ReportError::Version { found: version })
            }
            _ => Ok(serde_json::from_str(text)?),
        }
    }

    /// Returns the answers to the form's questions about the session, as far as the report knows them.
    pub fn session(&self) -> Session {
        Session::new(&self.world.name(), self.robots.len(), &self.settings.body)
    }

    /// Returns whether the ratings of the form are the report's own scores D, M and N. They are if a
    /// program drove and nobody filled the form.
    pub fn is_form_measured(&self) -> bool {
        let Scores { difficulty, mapping, navigation, .. } = self.scores;
        let scores = Dials { difficulty, mapping, navigation };
        self.feedback.as_ref().is_some_and(|form| form.ratings().map(Rating::value) == scores)
    }
}

/// The results of one robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotReport {
    /// Why its part ended; `None` if it had not ended.
    pub end: Option<EndReason>,
    /// Simulated time until then, in seconds.
    pub time: f64,
    /// Path length in metres.
    pub distance: f64,
    /// Turning in radians, left and right added.
    pub turning: f64,
    /// Number of collisions. Its name in files is `hits`.
    #[serde(rename = "hits")]
    pub collisions: u32,
    /// Number of recoveries.
    pub recoveries: u32,
    /// Distance in metres between the last estimated position and the true one.
    #[serde(default)]
    pub pose_error: f64,
}

impl<B: RobotBackend> Trial<B> {
    /// Returns the report of the trial so far. If a policy drove, the form is filled from measurements.
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
        let plugged_in = self.foreign().iter().filter(|part| !self.replaced().contains(part));
        let foreign: Vec<ForeignPart> = plugged_in.cloned().collect();
        let mut report = TrialReport {
            version: REPORT_VERSION,
            world: world.provenance.clone(),
            world_digest: world.digest().to_string(),
            log_digest: self.log().digest().to_string(),
            settings: self.settings().clone(),
            robots: (0..self.robots()).map(robot).collect(),
            scenario: self.scenario().cloned(),
            foreign,
            replaced: self.replaced().to_vec(),
            failure: self.failure().map(str::to_owned),
            scores,
            feedback: None,
        };
        let built_in = self.settings().policy.as_ref().and_then(Named::name);
        let policy = self.foreign().iter().find(|part| part.role == PartRole::Policy);
        let plugged_in = policy.map(|part| part.name.as_str());
        if let Some(policy) = plugged_in.or(built_in) {
            let tracks = self.score_tracks(&estimated);
            let measured = Measured { policy, world, scores: &scores, tracks: &tracks };
            // Scores are ratings from 0 to 10.
            report.feedback = measured.fill(&report.session()).ok();
        }
        Ok(report)
    }
}

#[cfg(test)]
mod tests {
    use super::TrialReport;

    #[test]
    fn reports_of_other_versions_are_named() {
        let error = |text: &str| TrialReport::from_json(text).expect_err("no report").to_string();
        assert_eq!(error("{\"version\": 999}"), "a report of version 999, expected version 2");
        let text = error("{\"version\": 2}");
        assert!(text.starts_with("this is not the report of a trial: missing field"), "{text}");
    }
}
