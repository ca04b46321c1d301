//! The laser scanners of robots, and their scans.

use bevy::prelude::*;
use envgen::Seed;
use envgen::geometry::Pose;
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, ScenarioSight};

/// A component of a laser at the mounting pose of the robot's model.
///
/// It detects all colliders except sensors and the robot's own colliders: walls, other robots and everything
/// else. Colliders with a [`HeightRange`](bevy_envgen::HeightRange) are detected only if the range contains
/// the height of the laser, and dark walls and obstacles only from a short distance. It detects people,
/// leaves and smoke of scenarios in the same manner as the laser of the flat simulator. The first scan is
/// taken in the first step, and later scans at the rate of the profile. The result is in [`LaserScan`].
/// Scenes and clones do not hold this component.
#[derive(Component, Reflect)]
#[component(clone_behavior = Ignore)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
#[require(LaserScan)]
pub struct LaserScanner {
    #[reflect(ignore)]
    pub(super) profile: LaserProfile,
    #[reflect(ignore)]
    pub(super) sensor: Box<dyn LaserSensor + Send + Sync>,
    #[reflect(ignore)]
    pub(super) sight: ScenarioSight,
    /// The number of the robot, which determines its random draws for smoke.
    pub(super) robot: u64,
    /// The ticks since the last scan, or `None` before the first scan.
    pub(super) age: Option<f64>,
}

impl LaserScanner {
    /// Creates the laser of robot number `robot`. Its noise depends on that number and on `seed`.
    ///
    /// # Panics
    /// Panics if [`LaserProfile::validate`] rejects the profile.
    pub fn new(profile: LaserProfile, seed: u64, robot: u64) -> Self {
        let sensor = Laser::new(profile.clone(), Seed(seed), robot);
        LaserScanner::with_sensor(profile, Box::new(sensor)).with_smoke_draws(seed, robot)
    }

    /// Creates a laser with the beams and the rate of `profile`, and a custom error model.
    pub fn with_sensor(profile: LaserProfile, sensor: Box<dyn LaserSensor + Send + Sync>) -> Self {
        let sight = ScenarioSight::new(&profile, Seed(0));
        LaserScanner { profile, sensor, sight, robot: 0, age: None }
    }

    /// Sets the seed and the robot's number on which the random echoes from smoke depend. Both are 0 by
    /// default.
    #[must_use]
    pub fn with_smoke_draws(mut self, seed: u64, robot: u64) -> Self {
        self.sight = ScenarioSight::new(&self.profile, Seed(seed));
        self.robot = robot;
        self
    }

    /// Returns the beams, range and rate of the laser.
    pub fn profile(&self) -> &LaserProfile {
        &self.profile
    }
}

impl Default for LaserScanner {
    /// Returns the SICK LMS 200 with the noise of seed 0.
    fn default() -> Self {
        LaserScanner::new(LaserProfile::default(), 0, 0)
    }
}

/// A component with the last scan of a [`LaserScanner`].
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct LaserScan {
    /// One range in metres per beam, from right to left. It is infinite if the beam hit nothing, and NaN if
    /// the beam must be ignored.
    pub ranges: Vec<f64>,
    /// The pose of the laser in the frame of rapier's world.
    #[reflect(ignore)]
    pub pose: Pose,
    /// The number of scans so far, which is 0 before the first scan.
    pub number: u64,
}
