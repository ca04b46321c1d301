//! Laser scanners with rapier's rays.

use bevy::prelude::*;
use bevy_envgen::HeightRange;
use bevy_rapier2d::prelude::{QueryFilter, ReadRapierContext};
use envgen::Seed;
use envgen::geometry::{Pose, unit_vector};
use envgen::glam::DVec2;
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor, ScenarioSight, UNSEEN};

use super::ground::Terrain;
use super::model::{RobotModel, TruePose};
use super::scenarios::Scenarios;

/// A laser at the mounting pose of the robot's model.
///
/// It detects all colliders except sensors and the robot's own: walls, other robots and anything else, where their
/// [`HeightRange`] has the laser's height, and dark walls and obstacles only from near. People, leaves and smoke of scenarios it detects as the flat simulator's laser
/// does. The first scan is taken in the first step, later ones at the profile's rate; the result is in [`LaserScan`].
#[derive(Component, Reflect)]
#[reflect(from_reflect = false)]
#[reflect(Component)]
#[require(LaserScan)]
pub struct LaserScanner {
    #[reflect(ignore)]
    profile: LaserProfile,
    #[reflect(ignore)]
    sensor: Box<dyn LaserSensor + Send + Sync>,
    #[reflect(ignore)]
    sight: ScenarioSight,
    /// The robot's number: its draws of smoke.
    robot: u64,
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
        LaserScanner::with_sensor(profile, Box::new(sensor)).with_smoke_draws(seed, robot)
    }

    /// A laser with the beams and the rate of `profile`, and a custom error model.
    pub fn with_sensor(profile: LaserProfile, sensor: Box<dyn LaserSensor + Send + Sync>) -> Self {
        let sight = ScenarioSight::new(&profile, Seed(0));
        LaserScanner { profile, sensor, sight, robot: 0, wait: 0 }
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

/// The ranges of a scan, kept to save allocations.
#[derive(Default)]
pub(super) struct Ranges {
    exact: Vec<f64>,
    directions: Vec<DVec2>,
    /// The beams that end at something too dark to be seen from there, and where.
    unseen: Vec<(usize, f64)>,
}

/// Takes the scans that are due.
pub(super) fn scan(
    mut robots: Query<(Entity, &RobotModel, &TruePose, &mut LaserScanner, &mut LaserScan)>,
    rapier: ReadRapierContext,
    terrain: Terrain,
    scenarios: Scenarios,
    // Robots are seen whatever their height, as in the flat simulator.
    heights: Query<&HeightRange, Without<RobotModel>>,
    mut ranges: Local<Ranges>,
) {
    let Ok(rapier) = rapier.single() else { return };
    let Ranges { exact, directions, unseen } = &mut *ranges;
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
        let height = model.laser_mount.height;
        let is_met = |entity| {
            // People and leaves are seen where the scenario has them.
            let is_missed = heights.get(entity).is_ok_and(|range| !range.contains(height));
            !is_missed && !scenarios.moves(entity)
        };
        let filter = filter.predicate(&is_met);
        let LaserScanner { profile, sensor, sight, robot, .. } = &mut *scanner;
        let beams = 0..profile.beams as usize;
        directions.clear();
        directions.extend(beams.map(|beam| unit_vector(from.heading + profile.angle(beam))));
        exact.clear();
        unseen.clear();
        rapier.with_query_pipeline(filter, |rays| {
            for (beam, &along) in directions.iter().enumerate() {
                let hit = rays.cast_ray(origin, along.as_vec2(), profile.max_range as f32, true);
                let range = hit.map_or(profile.max_range, |(_, range)| f64::from(range));
                if hit.is_some() && terrain.is_unseen(height, from.position, along, range) {
                    unseen.push((beam, range));
                }
                exact.push(range);
            }
        });
        let tick = scan.number * u64::from(profile.ticks_a_scan);
        let rays = mapping_trial::lidar::Rays {
            from: from.position,
            directions,
            max_range: profile.max_range,
        };
        let zero = scenarios.look(sight, (*robot, tick), &rays, exact);
        for &(beam, range) in &*unseen {
            if exact[beam] >= range {
                exact[beam] = UNSEEN;
            }
        }
        scan.ranges = sensor.measure(exact).ranges;
        for beam in zero {
            // A sensor of one's own may give fewer ranges.
            if let Some(range) = scan.ranges.get_mut(beam) {
                *range = 0.0;
            }
        }
        scan.pose = from;
        scan.number += 1;
    }
}
