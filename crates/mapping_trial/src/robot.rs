//! The robot that trials drive, and its numbers.

use envgen::SpecError;
use envgen::geometry::{Pose, unit_vector};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::trial::{MAX_TIME_LIMIT, number};

/// Size and limits of a robot. The default is the Pioneer 3-AT, which the operators of Zwennes
/// (2011) drove.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Robot {
    /// Length of the body in metres.
    pub length: f64,
    /// Width of the body in metres.
    pub width: f64,
    /// Radius in metres of the circle that the body sweeps when it turns on the spot.
    pub swing_radius: f64,
    /// Greatest speed in m/s, forwards and backwards.
    pub max_speed: f64,
    /// Greatest rate of turning in rad/s.
    pub max_turn_rate: f64,
    /// Greatest change of speed in m/s^2.
    pub acceleration: f64,
    /// Greatest change of the rate of turning in rad/s^2.
    pub turn_acceleration: f64,
    /// Place of the laser ahead of the middle, in metres.
    pub laser_offset: f64,
    /// Time in seconds that the battery lasts.
    pub battery: f64,
    /// How far in metres its camera tells water from floor, from 0 to 5. A robot of 0 is blind to
    /// water and drives into it.
    pub water_sight: f64,
}

impl Default for Robot {
    fn default() -> Self {
        Robot {
            length: 0.508,
            width: 0.497,
            swing_radius: 0.355,
            max_speed: 0.7,
            max_turn_rate: 1.4,
            acceleration: 0.5,
            turn_acceleration: 1.5,
            laser_offset: 0.21,
            battery: 1200.0,
            water_sight: 1.5,
        }
    }
}

/// Why a text is no robot.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// Line and column of what is wrong.
    #[error(transparent)]
    Ron(#[from] Box<ron::error::SpannedError>),
    /// A number that is not allowed.
    #[error(transparent)]
    Number(#[from] SpecError),
}

impl Robot {
    /// Checks every number.
    ///
    /// # Errors
    ///
    /// The first field whose value is not allowed, as `body.length`.
    pub fn validate(&self) -> Result<(), SpecError> {
        number("body.length", self.length, 0.01, 10.0)?;
        number("body.width", self.width, 0.01, 10.0)?;
        number("body.swing_radius", self.swing_radius, 0.05, 10.0)?;
        // A disc must not step over a wall, nor a robot turn past itself, within a tick.
        number("body.max_speed", self.max_speed, 0.01, (10.0 * self.swing_radius).min(20.0))?;
        number("body.max_turn_rate", self.max_turn_rate, 0.01, 20.0)?;
        number("body.acceleration", self.acceleration, 0.01, 100.0)?;
        number("body.turn_acceleration", self.turn_acceleration, 0.01, 100.0)?;
        number("body.laser_offset", self.laser_offset, -10.0, 10.0)?;
        number("body.battery", self.battery, 0.05, MAX_TIME_LIMIT)?;
        number("body.water_sight", self.water_sight, 0.0, 5.0)
    }

    /// Reads a robot from RON, such as `(length: 0.4, width: 0.4, max_speed: 1.2)`; what it does not
    /// name is the Pioneer's.
    ///
    /// # Errors
    ///
    /// What is wrong with the text, or the first field whose value is not allowed.
    pub fn from_ron(text: &str) -> Result<Self, RobotError> {
        let robot: Robot = ron::from_str(text).map_err(Box::new)?;
        robot.validate()?;
        Ok(robot)
    }

    /// Pose of the laser of a robot at `pose`.
    pub fn laser_pose(&self, pose: Pose) -> Pose {
        let ahead = unit_vector(pose.heading) * self.laser_offset;
        Pose { position: pose.position + ahead, heading: pose.heading }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_are_read_from_ron() {
        let robot = Robot::from_ron("(length: 0.4, max_speed: 1.2)").unwrap();
        assert_eq!(robot, Robot { length: 0.4, max_speed: 1.2, ..Robot::default() });
        assert_eq!(Robot::from_ron("()"), Ok(Robot::default()));
        let error = |text| Robot::from_ron(text).unwrap_err().to_string();
        assert_eq!(error("(width: -1)"), "`body.width` is -1, allowed is 0.01 to 10");
        assert!(error("(widht: 1)").contains("widht"), "{}", error("(widht: 1)"));
        assert!(error("(width: ").contains("1:9"), "{}", error("(width: "));
    }
}
