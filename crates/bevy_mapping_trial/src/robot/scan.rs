//! Takes laser scans with rapier's rays.

use bevy::prelude::*;
use bevy_envgen::HeightRange;
use bevy_rapier2d::prelude::{QueryFilter, ReadRapierContext};
use envgen::geometry::unit_vector;
use envgen::glam::DVec2;
use mapping_trial::backend::TICK;
use mapping_trial::lidar::UNSEEN;

use super::ground::Terrain;
use super::laser::{LaserScan, LaserScanner};
use super::model::{RobotModel, TruePose};
use super::scenarios::Scenarios;

/// The tolerance in ticks for the rounding of sums of steps.
const ROUNDING: f64 = 1e-6;

/// The buffers of a scan, which are kept to avoid allocations.
#[derive(Default)]
pub(super) struct Ranges {
    exact: Vec<f64>,
    directions: Vec<DVec2>,
    /// The beams that end at a surface that is too dark to give an echo, and their ranges.
    unseen: Vec<(usize, f64)>,
}

/// Takes the scans that are due.
pub(super) fn scan(
    time: Res<Time>,
    mut robots: Query<(Entity, &RobotModel, &TruePose, &mut LaserScanner, &mut LaserScan)>,
    rapier: ReadRapierContext,
    terrain: Terrain,
    scenarios: Scenarios,
    // Robots are detected at any height, as in the flat simulator.
    heights: Query<&HeightRange, Without<RobotModel>>,
    mut ranges: Local<Ranges>,
) {
    let Ok(rapier) = rapier.single() else { return };
    let ticks = time.delta_secs_f64() / TICK;
    let Ranges { exact, directions, unseen } = &mut *ranges;
    for (entity, model, pose, mut scanner, mut scan) in &mut robots {
        if !rapier.rigidbody_set.entity2body().contains_key(&entity) {
            continue;
        }
        // If steps are not whole ticks, a remainder is left.
        let period = f64::from(scanner.profile().ticks_a_scan.max(1));
        let age = scanner.age.map_or(period, |age| age + ticks);
        scanner.age = Some(age);
        if age < period - ROUNDING {
            continue;
        }
        scanner.age = Some((age - period).max(0.0) % period);
        let from = model.laser_pose(pose.pose());
        let origin = from.position.as_vec2();
        let filter = QueryFilter::new().exclude_rigid_body(entity).exclude_sensors();
        let height = model.laser_mount.height;
        let is_met = |entity| {
            // The height of a body is on its own entity, or on the entity of one of its colliders.
            let body = || rapier.colliders.collider_parent(rapier.rigidbody_set, entity);
            let range = heights.get(entity).ok().or_else(|| heights.get(body()?).ok());
            let is_missed = range.is_some_and(|range| !range.contains(height));
            // People and leaves are detected where the scenario has them.
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
            // A custom sensor may return fewer ranges.
            if let Some(range) = scan.ranges.get_mut(beam) {
                *range = 0.0;
            }
        }
        scan.pose = from;
        scan.number += 1;
    }
}
