//! The settings of a trial.

use envgen::geometry::Pose;
use envgen::{Seed, SpecError};
use serde::{Deserialize, Serialize};

use crate::lidar::LaserProfile;
use crate::limits::{MAX_TIME_LIMIT, count, number};
use crate::odometry::OdometryProfile;
use crate::policy::PolicyKind;
use crate::robot::Robot;
use crate::slam::SlamKind;

/// Greatest number of robots in a trial.
pub const MAX_ROBOTS: u32 = 8;

/// Everything that a trial depends on except its world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrialSettings {
    /// Seed of the sensor noise.
    pub seed: Seed,
    /// The exploration policy that drives, `operator` in files; `None` for a person.
    #[serde(rename = "operator", alias = "policy")]
    pub policy: Option<PolicyKind>,
    /// How poses and map are estimated.
    pub slam: SlamKind,
    /// Number of robots, which share one map; from 1 to [`MAX_ROBOTS`].
    pub robots: u32,
    /// Simulated seconds after which the trial ends; more than 0, at most [`MAX_TIME_LIMIT`].
    pub time_limit: f64,
    /// Where the first robot starts, in metres and radians; `None` is the world's own start.
    pub start: Option<Pose>,
    /// Size and limits of the robots.
    pub body: Robot,
    /// What their lasers measure.
    pub laser: LaserProfile,
    /// What their wheels measure.
    pub odometry: OdometryProfile,
}

impl Default for TrialSettings {
    /// One P3-AT with an LMS 200, `scan_to_map` and the policy `nearest` for 20 minutes.
    fn default() -> Self {
        TrialSettings {
            seed: Seed(0),
            policy: Some(PolicyKind::Nearest),
            slam: SlamKind::ScanToMap,
            robots: 1,
            time_limit: 1200.0,
            start: None,
            body: Robot::default(),
            laser: LaserProfile::default(),
            odometry: OdometryProfile::default(),
        }
    }
}

impl TrialSettings {
    /// Checks every number.
    ///
    /// # Errors
    ///
    /// The first field whose value is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        count("robots", self.robots, 1, MAX_ROBOTS)?;
        number("time_limit", self.time_limit, 0.05, MAX_TIME_LIMIT)?;
        if let Some(start) = self.start {
            number("start.x", start.position.x, -1e6, 1e6)?;
            number("start.y", start.position.y, -1e6, 1e6)?;
            number("start.heading", start.heading, -1e3, 1e3)?;
        }
        self.body.validate()?;
        self.laser.validate()?;
        self.odometry.validate()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_allowed() {
        assert_eq!(TrialSettings::default().validate(), Ok(()));
        for laser in [LaserProfile::USARSIM, LaserProfile::LMS200_MM, LaserProfile::LMS200_MM_ROUGH]
        {
            assert_eq!(TrialSettings { laser, ..Default::default() }.validate(), Ok(()));
        }
    }

    #[test]
    fn files_call_the_policy_operator_and_may_call_it_policy() {
        let settings = TrialSettings { policy: None, ..Default::default() };
        let text = serde_json::to_string(&settings).expect("JSON");
        assert!(text.contains("\"operator\":null"), "{text}");
        let text = text.replace("operator", "policy");
        assert_eq!(serde_json::from_str::<TrialSettings>(&text).expect("settings"), settings);
    }

    #[test]
    fn every_bad_number_is_named() {
        let error = |change: &dyn Fn(&mut TrialSettings)| {
            let mut settings = TrialSettings::default();
            change(&mut settings);
            settings.validate().expect_err("not allowed").to_string()
        };
        let text = error(&|s| s.robots = 0);
        assert_eq!(text, "`robots` must be a whole number from 1 to 8, got 0");
        assert!(error(&|s| s.time_limit = f64::NAN).contains("`time_limit` must be"));
        assert!(error(&|s| s.time_limit = 1e9).contains("86400"));
        assert!(error(&|s| s.start = Some(Pose::new(f64::INFINITY, 0.0, 0.0))).contains("start.x"));
        assert!(
            error(&|s| s.body.circumscribed_radius = -1.0).contains("body.circumscribed_radius")
        );
        assert!(error(&|s| s.body.max_speed = 50.0).contains("body.max_speed"));
        assert!(error(&|s| s.body.water_sight = f64::NAN).contains("body.water_sight"));
        assert!(error(&|s| s.laser.beams = 0).contains("laser.beams"));
        assert!(error(&|s| s.laser.dropout = 1.5).contains("laser.dropout"));
        assert!(error(&|s| s.odometry.k_tt = f64::NAN).contains("odometry.k_tt"));
    }
}
