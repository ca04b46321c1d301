//! The robot that trials drive, and its numbers.

use envgen::geometry::{Pose, unit_vector};
use serde::{Deserialize, Serialize};

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

impl Robot {
    /// Pose of the laser of a robot at `pose`.
    pub fn laser_pose(&self, pose: Pose) -> Pose {
        let ahead = unit_vector(pose.heading) * self.laser_offset;
        Pose { position: pose.position + ahead, heading: pose.heading }
    }
}
