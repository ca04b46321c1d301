//! Laser scanners with rapier's rays.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{QueryFilter, ReadRapierContext};
use envgen::Seed;
use envgen::geometry::{Pose, unit_vector};
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, UNSEEN};

use super::ground::Terrain;
use super::model::{RobotModel, TruePose};

/// A laser at the mounting pose of the robot's model.
///
/// It detects all colliders except sensors and the robot's own: walls, doors as far as they are
/// closed, other robots and anything else, and dark walls and obstacles only from near. The first scan
/// is taken in the first step, later ones at the profile's rate; the result is in [`LaserScan`].
#[derive(Component, Reflect)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
#[require(LaserScan)]
pub struct LaserScanner {
    #[reflect(ignore)]
    profile: LaserProfile,
    #[reflect(ignore)]
    sensor: Box<dyn LaserSensor + Send + Sync>,
    /// Steps until the next scan.
    wait: u32,
}

impl LaserScanner {
    /// The laser of robot number `robot`; its noise depends on that number and on `seed`.
    ///
    /// # Panics
    /// If [`LaserProfile::validate`] rejects the profile.
    pub fn new(profile: LaserProfile, seed: u64, robot: u64) -> Self {
        let sensor = Laser::new(profile.clone(), Seed(seed), robot);
        LaserScanner::with_sensor(profile, Box::new(sensor))
    }

    /// A laser with the beams and the rate of `profile`, and a custom error model.
    pub fn with_sensor(profile: LaserProfile, sensor: Box<dyn LaserSensor + Send + Sync>) -> Self {
        LaserScanner { profile, sensor, wait: 0 }
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

/// Takes the scans that are due.
pub(super) fn scan(
    mut robots: Query<(Entity, &RobotModel, &TruePose, &mut LaserScanner, &mut LaserScan)>,
    rapier: ReadRapierContext,
    terrain: Terrain,
    mut exact: Local<Vec<f64>>,
) {
    let Ok(rapier) = rapier.single() else { return };
    for (entity, model, pose, mut scanner, mut scan) in &mut robots {
        if !rapier.rigidbody_set.entity2body().contains_key(&entity) {
            continue;
        }
        if scanner.wait > 0 {
            scanner.wait -= 1;
            continue;
        }
        scanner.wait = scanner.profile().ticks_a_scan.max(1) - 1;
        let from = model.laser_pose(pose.pose());
        let origin = from.position.as_vec2();
        let filter = QueryFilter::new().exclude_rigid_body(entity).exclude_sensors();
        rapier.with_query_pipeline(filter, |rays| {
            let profile = scanner.profile();
            exact.clear();
            exact.extend((0..profile.beams as usize).map(|beam| {
                let along = unit_vector(from.heading + profile.angle(beam));
                let hit = rays.cast_ray(origin, along.as_vec2(), profile.max_range as f32, true);
                let Some((_, range)) = hit else { return profile.max_range };
                let range = f64::from(range);
                if terrain.is_unseen(from.position, along, range) { UNSEEN } else { range }
            }));
        });
        let measured = scanner.sensor.measure(&exact);
        scan.ranges = measured.ranges;
        scan.pose = from;
        scan.number += 1;
    }
}
