//! The cost of the meshes of worlds in three dimensions, against that of the pure meshes that they are made of.

use std::hint::black_box;
use std::sync::Arc;

use bench_ratio::{at_most, seconds};
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::mesh::Mesh as Solid;
use bevy_envgen::envgen::pieces::pieces;
use bevy_envgen::envgen::{Seed, World as EnvgenWorld, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_envgen::visuals3d::TileMesh;

/// The number of alternating rounds, of which the best time of each side counts.
const ROUNDS: usize = 9;

fn main() {
    let indoor = IndoorSpec { width: 16, height: 16, ..default() };
    building("an indoor map of 16 x 16", &indoor.into(), 30.0);
    let side = 1000.0;
    let forest = ForestSpec { width: side, height: side, intensity: 0.1, radius: 0.2, ..default() };
    planting("a forest", &forest.into());
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn say(line: &str) {
    println!("{line}");
}

fn world(spec: &WorldSpec) -> Option<Arc<EnvgenWorld>> {
    match spec.generate(Seed(1)) {
        Ok(blueprint) => Some(Arc::new(blueprint.to_world())),
        Err(error) => {
            say(&format!("no world: {error}"));
            None
        }
    }
}

/// Creates an app that only spawns worlds, with or without meshes.
fn app(draws: bool) -> App {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), AssetPlugin::default(), MeshPlugin));
    app.init_asset::<StandardMaterial>().init_asset::<Image>();
    app.add_plugins(EnvgenCorePlugin::default());
    if draws {
        app.add_plugins(EnvgenVisuals3dPlugin::default());
    }
    app.update();
    app
}

/// Returns the seconds until a world is spawned, and the number of meshes.
fn spawning(world: &Arc<EnvgenWorld>, draws: bool) -> (f64, usize) {
    let mut app = app(draws);
    // Assets that worlds share are created before.
    let rooms = IndoorSpec { width: 6, height: 6, ..default() };
    let small = Environment::new(rooms, 1).with_pace(GenerationMode::Blocking);
    let small = app.world_mut().spawn(small).id();
    app.update();
    app.world_mut().despawn(small);
    let environment = Environment::prebuilt(Arc::clone(world)).with_pace(GenerationMode::Blocking);
    app.world_mut().spawn(environment);
    let time = seconds(|| app.world_mut().run_schedule(Update));
    (time, app.world_mut().query::<&TileMesh>().iter(app.world()).count())
}

/// Returns the best times with meshes and without, and the number of meshes.
fn times(world: &Arc<EnvgenWorld>) -> (f64, f64, usize) {
    let mut best = (f64::INFINITY, f64::INFINITY, 0);
    for _ in 0..ROUNDS {
        let (drawn, count) = spawning(world, true);
        best = (best.0.min(drawn), best.1.min(spawning(world, false).0), count);
    }
    best
}

/// Measures tiles whose bodies are merged, including the light.
fn building(name: &str, spec: &WorldSpec, limit: f64) {
    let Some(world) = world(spec) else { return };
    let (drawn, bare, count) = times(&world);
    let mut pure = f64::INFINITY;
    for _ in 0..ROUNDS {
        pure = pure.min(seconds(|| {
            pieces(&world).iter().for_each(|piece| drop(black_box(Solid::of(piece))));
        }));
    }
    let ours = drawn - bare;
    let text = format!("{:.1} ms for {count} meshes, {:.1} ms pure", 1e3 * ours, 1e3 * pure);
    say(&format!("{name}: {text}"));
    at_most("from parts to meshes and light, against a millisecond", (1e3 * ours, 1.0), limit);
}

/// Measures trees, which share their meshes.
fn planting(name: &str, spec: &WorldSpec) {
    let Some(world) = world(spec) else { return };
    let (drawn, bare, count) = times(&world);
    let [drawn, bare] = [drawn, bare].map(|time| 1e3 * time);
    let trees = world.trees.len();
    say(&format!("{name} of {trees} trees: {count} meshes, {drawn:.0} ms, without {bare:.0} ms"));
    at_most("trees with meshes, against trees without", (drawn, bare), 4.0);
}
