//! Spawns a world of every kind side by side in a headless Bevy app, runs physics for 500 fixed steps
//! with a moving robot in each, casts rays, and prints the results.
//!
//! `cargo run --release --example headless_world`

use std::collections::BTreeMap;

use bevy::ecs::error::Result;
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::WorldKind;
use bevy_envgen::envgen::raycast::Raycaster;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{parts, spawn_ready, step, test_app};

/// Number of rays of a robot's scanner, and their range in metres.
const RAYS: usize = 16;
const RANGE: f32 = 20.0;

#[expect(clippy::print_stdout, reason = "the output of an example")]
fn main() -> Result {
    let mut app = test_app();
    for (place, &kind) in (0_u8..).zip(WorldKind::ALL) {
        let world = spawn_ready(&mut app, Environment::new(kind.default_spec(), 7))?;
        let offset = Vec3::Y * 3000.0 * f32::from(place);
        app.world_mut().entity_mut(world).insert(Transform::from_translation(offset));
        let mut counts = BTreeMap::new();
        for part in parts(&app, world) {
            *counts.entry(part.id.kind.name()).or_insert(0) += 1;
        }
        println!("{kind}: {counts:?}");

        // A robot at the start, with an initial speed.
        let Some(truth) = app.world().get::<GroundTruth>(world).cloned() else { continue };
        let Some(start) = truth.start else { continue };
        let from = start.position.as_vec2().extend(0.0) + offset;
        let robot = (
            Transform::from_translation(from),
            RigidBody::Dynamic,
            Collider::ball(0.2),
            Restitution::coefficient(0.9),
            Velocity::linear(Vec2::from_angle(start.heading as f32) * 2.0),
            Ccd::enabled(),
        );
        let robot = app.world_mut().spawn(robot).id();
        step(&mut app, 500);
        let Some(to) = app.world().get::<Transform>(robot).map(|at| at.translation) else {
            continue;
        };
        println!("  after 500 steps the robot is {:.2} m from its start", to.distance(from));

        // The ranges of its scanner, by Rapier and exact.
        let see = move |rapier: ReadRapierContext| scan(&rapier, robot, to.truncate());
        let ranges: Vec<f32> = match app.world_mut().run_system_once(see) {
            Ok(ranges) => ranges,
            Err(error) => return Err(error.to_string().into()),
        };
        let rays = Raycaster::new(&truth);
        let here = (to - offset).truncate().as_dvec2();
        let mut worst = 0.0_f64;
        for (i, range) in ranges.iter().enumerate() {
            let heading = f64::from(angle(i));
            let exact = rays.cast(here, heading, f64::from(RANGE));
            let exact = exact.map_or(f64::from(RANGE), |hit| hit.distance);
            worst = worst.max((exact - f64::from(*range)).abs());
        }
        let nearest = ranges.iter().copied().fold(RANGE, f32::min);
        println!("  {RAYS} rays, the shortest {nearest:.2} m, at most {:.2} mm off", 1e3 * worst);
        app.world_mut().despawn(robot);
    }
    Ok(())
}

fn angle(ray: usize) -> f32 {
    std::f32::consts::TAU * ray as f32 / RAYS as f32
}

/// Returns the ranges of rays in all directions.
fn scan(rapier: &ReadRapierContext, robot: Entity, from: Vec2) -> Result<Vec<f32>> {
    let rapier = rapier.single()?;
    let filter = QueryFilter::default().exclude_sensors().exclude_collider(robot);
    let range = |ray| {
        let hit = rapier.cast_ray(from, Vec2::from_angle(angle(ray)), RANGE, true, filter);
        hit.map_or(RANGE, |(_, distance)| distance)
    };
    Ok((0..RAYS).map(range).collect())
}
