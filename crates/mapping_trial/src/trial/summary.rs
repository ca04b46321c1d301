//! Summaries of reports in words.

use super::{PartRole, RobotReport, TrialReport};
use crate::names::Named;

/// Error in metres of the last estimated position above which a summary states it.
pub(crate) const LOST: f64 = 0.5;

impl TrialReport {
    /// Returns what drove, and with which parts:
    /// `nearest with scan_to_map and lms200_mm, 434 m^2 to map`. A driver that is SLAM as well is
    /// named once.
    pub fn headline(&self) -> String {
        let name = |role, built_in: Option<&'static str>| {
            let part = self.foreign.iter().find(|part| part.role == role);
            part.map(|part| part.name.as_str()).or(built_in)
        };
        let settings = &self.settings;
        let policy = name(PartRole::Policy, settings.policy.as_ref().and_then(Named::name))
            .unwrap_or("a person");
        let slam = name(PartRole::Slam, settings.slam.name()).unwrap_or("custom");
        let laser = name(PartRole::Laser, settings.laser.name()).unwrap_or("a custom laser");
        let parts = if policy == slam { laser.to_owned() } else { format!("{slam} and {laser}") };
        format!("{policy} with {parts}, {:.0} m^2 to map", self.scores.free_area)
    }
}

impl RobotReport {
    /// Returns the result of the robot:
    /// `time up after 1200 s, 226 m, 105 rad, 0 collisions, 2 recoveries`. A robot whose last estimated
    /// position is more than 0.5 m from the true one is called lost.
    pub fn summary(&self) -> String {
        let mut text = format!(
            "{} after {:.0} s, {:.0} m, {:.0} rad, {} collisions, {} recoveries",
            self.end.map_or("in progress", |end| end.text()),
            self.time,
            self.distance,
            self.turning,
            self.collisions,
            self.recoveries
        );
        if self.pose_error > LOST {
            text += &format!(", lost: {:.1} m from its estimated position", self.pose_error);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::EndReason;

    #[test]
    fn a_robot_that_is_lost_is_said_to_be() {
        let mut robot = RobotReport {
            end: Some(EndReason::Explored),
            time: 100.0,
            distance: 50.0,
            turning: 20.0,
            collisions: 1,
            recoveries: 0,
            pose_error: 0.2,
        };
        let end = "explored after 100 s, 50 m, 20 rad, 1 collisions, 0 recoveries";
        assert_eq!(robot.summary(), end);
        robot.pose_error = 4.27;
        assert_eq!(robot.summary(), format!("{end}, lost: 4.3 m from its estimated position"));
    }
}
