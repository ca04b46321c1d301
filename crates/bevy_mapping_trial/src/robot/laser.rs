//! Laser scanners of robots, and their scans.

use bevy::prelude::*;
use envgen::Seed;
use envgen::geometry::Pose;
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, ScenarioSight};

/// A laser at the mounting pose of the robot's model.
///
/// It detects all colliders except sensors and the robot's own: walls, other robots and anything else, where their
/// [`HeightRange`](bevy_envgen::HeightRange) has the laser's height, and dark walls and obstacles only from near.
/// People, leaves and smoke of scenarios it detects as the flat simulator's laser does. The first scan is taken in the
/// first step, later ones at the profile's rate; the result is in [`LaserScan`]. Scenes and clones do not hold it.
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
    /// The robot's number: its draws of smoke.
    pub(super) robot: u64,
    /// Ticks since the last scan; `None` before the first.
    pub(super) age: Option<f64>,
}

impl LaserScanner {
    /// The laser of robot number `robot`; its noise depends on that number and on `seed`.
    ///
    /// # Panics
    /// If [`LaserProfile::validate`] rejects the profile.
    pub fn new(profile: LaserProfile, seed: u64, robot: u64) -> Self {
        let sensor = Laser::new(profile.clone(), Seed(seed), robot);
        LaserScanner::with_sensor(profile, Box::new(sensor)).with_smoke_draws(seed, robot)
    }

    /// A laser with the beams and the rate of `profile`, and a custom error model.
    pub fn with_sensor(profile: LaserProfile, sensor: Box<dyn LaserSensor + Send + Sync>) -> Self {
        let sight = ScenarioSight::new(&profile, Seed(0));
        LaserScanner { profile, sensor, sight, robot: 0, age: None }
    }

    /// With draws of echoes from smoke that follow from a seed and the robot's number, instead of 0 and 0.
    #[must_use]
    pub fn with_smoke_draws(mut self, seed: u64, robot: u64) -> Self {
        self.sight = ScenarioSight::new(&self.profile, Seed(seed));
        self.robot = robot;
        self
    }

    /// The beams, range and rate of the laser.
    pub fn profile(&self) -> &LaserProfile {
        &self.profile
    }
}

impl Default for LaserScanner {
    /// The SICK LMS 200 with the noise of seed 0.
    fn default() -> Self {
        LaserScanner::new(LaserProfile::default(), 0, 0)
    }
}

/// The last scan of a [`LaserScanner`].
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct LaserScan {
    /// One range in metres per beam, from right to left: infinite where the beam met nothing, NaN
    /// where it is to be ignored.
    pub ranges: Vec<f64>,
    /// The pose of the laser, in the frame of rapier's world.
    #[reflect(ignore)]
    pub pose: Pose,
    /// Number of scans so far, 0 before the first.
    pub number: u64,
}
