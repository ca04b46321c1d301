//! Exact rays against rapier's in the same worlds: laser scans of a robot at many positions.

use bench_ratio::{contest, faster};
use bevy::ecs::system::SystemState;
use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::prelude::*;
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::geometry::{Pose, unit_vector};
use bevy_envgen::envgen::glam::DVec2;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::raycast::{Raycaster, ScanPattern};
use bevy_envgen::envgen::{Seed, WorldSpec};
use bevy_envgen::physics::ColliderMerging;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app, truth, wait_until_ready};

/// The range of the laser in metres, which is that of the SICK LMS 200 in millimetre mode.
const RANGE: f64 = 8.19;

/// The number of beams per scan, over half a circle.
const BEAMS: usize = 181;

/// The number of scan positions per world.
const PLACES: usize = 100;

/// How many times faster than rapier's rays the exact rays should be.
const TARGET: f64 = 3.0;

fn main() {
    race("an indoor map", IndoorSpec::default().into());
    let forest = ForestSpec { width: 200.0, height: 200.0, ..default() };
    race("a forest", forest.into());
}

fn race(name: &str, spec: WorldSpec) {
    for merge in [ColliderMerging::Never, ColliderMerging::Always] {
        let mut app = test_app();
        let colliders = EnvironmentColliders(ColliderSettings { merge, ..default() });
        let root = app.world_mut().spawn((Environment::new(spec.clone(), 1), colliders)).id();
        if let Err(error) = wait_until_ready(&mut app, root) {
            panic!("{name}: {error}");
        }
        step(&mut app, 2);
        let world = truth(&app, root);

        let caster = Raycaster::new(&world);
        let mut draws = Seed(1).stream("bench/places", 0);
        let places: Vec<Pose> = std::iter::repeat_with(|| {
            let at = DVec2::new(draws.unit(), draws.unit()) * world.bounds.size();
            Pose { position: world.bounds.min + at, heading: draws.between(-3.1, 3.1) }
        })
        .filter(|place| world.clearance(place.position) > 0.4)
        .take(PLACES)
        .collect();
        let fan = ScanPattern::new(std::f64::consts::PI, BEAMS).expect("half a turn");
        let ours = || {
            let mut ranges = Vec::new();
            let scan = |&place: &Pose| {
                caster.scan(place, &fan, RANGE, &mut ranges);
                ranges.iter().sum::<f64>()
            };
            places.iter().map(scan).sum::<f64>()
        };

        let mut state = SystemState::<ReadRapierContext>::new(app.world_mut());
        let context = state.get(app.world()).expect("rapier is there");
        let context = context.single().expect("one rapier context");
        let filter = QueryFilter::default().exclude_sensors();
        let rapier = || {
            let scan = |place: &Pose| {
                let from = place.position.as_vec2();
                (0..BEAMS)
                    .map(|beam| {
                        let turn = std::f64::consts::PI * (beam as f64 / (BEAMS - 1) as f64 - 0.5);
                        let direction = unit_vector(place.heading + turn).as_vec2();
                        let hit = context.cast_ray(from, direction, RANGE as f32, true, filter);
                        hit.map_or(RANGE, |(_, distance)| f64::from(distance))
                    })
                    .sum::<f64>()
            };
            places.iter().map(scan).sum::<f64>()
        };
        let (a, b) = (ours(), rapier());
        assert!((a - b).abs() < 1e-3 * b, "{name}: the rays see different worlds, {a} and {b}");
        let how = if merge == ColliderMerging::Never {
            "one collider per part"
        } else {
            "merged colliders"
        };
        faster(&format!("rays in {name}, {how}, against rapier"), contest(ours, rapier), TARGET);
    }
}
