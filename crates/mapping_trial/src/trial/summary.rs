//! A report in words.

use super::{PartRole, RobotReport, TrialReport};
use crate::names::Named;

impl TrialReport {
    /// What drove, and with which parts: `nearest with scan_to_map and lms200_mm, 434 m^2 to map`.
    pub fn headline(&self) -> String {
        let name = |role, built_in: Option<&'static str>| {
            let part = self.foreign.iter().find(|part| part.role == role);
            part.map(|part| part.name.as_str()).or(built_in)
        };
        let settings = &self.settings;
        format!(
            "{} with {} and {}, {:.0} m^2 to map",
            name(PartRole::Policy, settings.policy.as_ref().and_then(Named::name))
                .unwrap_or("a person"),
            name(PartRole::Slam, settings.slam.name()).unwrap_or("custom"),
            name(PartRole::Laser, settings.laser.name()).unwrap_or("custom"),
            self.scores.free_area
        )
    }
}

impl RobotReport {
    /// The result of the robot: `time up after 1200 s, 226 m, 105 rad, 0 collisions, 2 recoveries`.
    pub fn summary(&self) -> String {
        format!(
            "{} after {:.0} s, {:.0} m, {:.0} rad, {} collisions, {} recoveries",
            self.end.map_or("under way", |end| end.text()),
            self.time,
            self.distance,
            self.turning,
            self.hits,
            self.recoveries
        )
    }
}
