//! A report in words.

use super::{RobotReport, TrialReport};
use crate::names::Named;

impl TrialReport {
    /// Who drove with what: `nearest with scan_to_map and lms200_mm, 434 m^2 to map`.
    pub fn headline(&self) -> String {
        let name = |name: Option<&'static str>| name.unwrap_or("custom");
        let operator = self.settings.operator.as_ref().map_or("a person", |kind| name(kind.name()));
        format!(
            "{operator} with {} and {}, {:.0} m^2 to map",
            name(self.settings.slam.name()),
            name(self.settings.laser.name()),
            self.scores.free_area
        )
    }
}

impl RobotReport {
    /// What became of the robot: `time up after 1200 s, 226 m, 105 rad, 0 hits, 2 recoveries`.
    pub fn summary(&self) -> String {
        format!(
            "{} after {:.0} s, {:.0} m, {:.0} rad, {} hits, {} recoveries",
            self.end.map_or("under way", |end| end.text()),
            self.time,
            self.distance,
            self.turning,
            self.hits,
            self.recoveries
        )
    }
}
