//! The settings of a trial.

use envgen::geometry::Pose;
use envgen::world::MAX_COORDINATE;
use envgen::{Seed, SpecError, settings};

use crate::lidar::LaserProfile;
use crate::odometry::OdometryProfile;
use crate::policy::PolicyKind;
use crate::robot::Robot;
use crate::setting_limits::{MAX_TIME_LIMIT, number};
use crate::slam::{SlamKind, WheelCalibration};

/// Least time limit in seconds that [`TrialSettings::time_per_area`] gives.
pub const MIN_TIME_BY_AREA: f64 = 300.0;

/// Greatest number of robots in a trial.
pub const MAX_ROBOTS: u32 = 8;

settings! {
    /// Everything that a trial depends on except its world. By default one P3-AT with an LMS 200 drives
    /// for 20 minutes, with `scan_to_map` and the policy `nearest`.
    ///
    /// ```
    /// use mapping_trial::{slam::SlamKind, trial::TrialSettings};
    ///
    /// // Two robots that share one map, with loop closing.
    /// let settings = TrialSettings { robots: 2, slam: SlamKind::PoseGraph, ..Default::default() };
    /// assert_eq!(settings.validate(), Ok(()));
    /// let error = TrialSettings { robots: 9, ..settings }.validate().unwrap_err();
    /// assert_eq!(error.to_string(), "`robots` must be a whole number from 1 to 8, got 9");
    /// ```
    pub struct TrialSettings {
        /// Seed of the sensor noise.
        seed: Seed = Seed(0) => other("", "a whole number");
        /// The exploration policy that drives, `operator` in files; none for a person.
        #[serde(rename = "operator", alias = "policy")]
        policy: Option<PolicyKind> = Some(PolicyKind::Nearest) => optional_other("", "a policy's name");
        /// How poses and map are estimated.
        slam: SlamKind = SlamKind::ScanToMap => other("", "an estimator's name");
        /// Which systematic errors of the wheels are learned.
        #[serde(skip_serializing_if = "WheelCalibration::is_default")]
        wheel_calibration: WheelCalibration = WheelCalibration::Turns =>
            other("", "none, turns or turns_and_distances");
        /// Number of robots, which share one map.
        robots: u32 = 1 => integer("", 1..=MAX_ROBOTS as u64);
        /// Simulated time after which the trial ends.
        time_limit: f64 = 1200.0 => number("s", 0.05..=MAX_TIME_LIMIT);
        /// Simulated time per square metre that can be mapped after which the trial ends, in place of
        /// `time_limit`: at least 300 s in all. The battery lasts at least as long.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time_per_area: Option<f64> = None => optional_number("s/m^2", 0.01..=1000.0);
        /// Where the first robot starts, in metres and radians; none is the world's own start.
        start: Option<Pose> = None => optional_other("", "a pose");
        /// Size and limits of the robots.
        body: Robot = Robot::default() => nested;
        /// What their lasers measure.
        laser: LaserProfile = LaserProfile::default() => nested;
        /// What their wheels measure.
        odometry: OdometryProfile = OdometryProfile::default() => nested;
    }
}

impl TrialSettings {
    /// Sets the time limit, and the least charge of the battery, for an area in square metres that can
    /// be mapped, if [`TrialSettings::time_per_area`] is set.
    pub(super) fn limit_time(&mut self, area: f64) {
        if let Some(per_area) = self.time_per_area {
            self.time_limit = (per_area * area).clamp(MIN_TIME_BY_AREA, MAX_TIME_LIMIT);
            self.body.battery = self.body.battery.max(self.time_limit);
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        self.laser.validate()?;
        if let Some(start) = self.start {
            number("start.x", start.position.x, -MAX_COORDINATE, MAX_COORDINATE)?;
            number("start.y", start.position.y, -MAX_COORDINATE, MAX_COORDINATE)?;
            number("start.heading", start.heading, -1e3, 1e3)?;
        }
        self.body.validate()
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
    fn logs_state_a_calibration_that_older_ones_cannot_have() {
        let settings = TrialSettings::default();
        let both = WheelCalibration::TurnsAndDistances;
        let other = TrialSettings { wheel_calibration: both, ..settings.clone() };
        let json = |settings: &TrialSettings| serde_json::to_string(settings).expect("JSON");
        assert!(!json(&settings).contains("wheel_calibration"), "{}", json(&settings));
        assert!(json(&other).contains("\"wheel_calibration\":\"turns_and_distances\""));
        for settings in [settings, other] {
            let again = serde_json::from_str::<TrialSettings>(&json(&settings));
            assert_eq!(again.expect("settings"), settings);
        }
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
        let text = error(&|s| (s.laser.dropout, s.laser.short) = (0.75, 0.5));
        assert!(text.starts_with("`laser.short` must be so small that `dropout`, "), "{text}");
        assert!(
            text.ends_with("got 0.5: a beam has one fault at most, and they sum to 1.25"),
            "{text}"
        );
        assert!(error(&|s| s.odometry.k_tt = f64::NAN).contains("odometry.k_tt"));
    }
}
