//! The cost of spawning, of a world at rest and of streaming, against hand-written baselines.

use std::sync::Arc;
use std::time::Duration;

use bench_ratio::{Times, at_most, seconds};
use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::prelude::{Collider, Friction, Restitution, RigidBody};
use bevy_envgen::envgen::forest::ForestSpec;
use bevy_envgen::envgen::{Blueprint, Seed, Spec, World as EnvgenWorld};
use bevy_envgen::physics::ColliderMerging;
use bevy_envgen::prelude::*;
use bevy_envgen::testing::{step, test_app, wait_until_ready};
use bevy_envgen::{StreamingReport, Tile};

/// The number of alternating rounds, of which the best time of each side counts.
const ROUNDS: usize = 9;

fn main() {
    let side = 1000.0;
    let spec = ForestSpec { width: side, height: side, intensity: 0.1, radius: 0.2, ..default() };
    match spec.generate(Seed(1)) {
        Ok(forest) => {
            let world = Arc::new(forest.to_world());
            say(&format!("a forest of {} trees", world.trees.len()));
            spawning(&world);
            resting(&world);
        }
        Err(error) => say(&format!("no forest: {error}")),
    }
    streaming();
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn say(line: &str) {
    println!("{line}");
}

/// Creates an app that only spawns worlds.
fn bare_app() -> App {
    let mut app = App::new();
    app.add_plugins((EnvgenCorePlugin::default(), EnvgenPhysicsPlugin::default()));
    app.update();
    app
}

/// Measures the time from a world to entities with colliders, against a hand-written `spawn_batch` of the
/// same components. The baseline knows the trees of each tile in advance, and looks nothing up.
fn spawning(world: &Arc<EnvgenWorld>) {
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let mut app = bare_app();
        let environment =
            Environment::prebuilt(Arc::clone(world)).with_pace(GenerationMode::Blocking);
        app.world_mut().spawn(environment);
        let ours = seconds(|| app.world_mut().run_schedule(Update));

        let tiles = tiles(&mut app);
        let mut bare = World::new();
        times.push((ours, seconds(|| by_hand(&mut bare, world, &tiles))));
    }
    let times: Times = times.into_iter().collect();
    say(&format!("  {:.0} ms, by hand {:.0} ms", 1e3 * times.ours(), 1e3 * times.baseline()));
    at_most("from a world to children with colliders, against spawn_batch", times, 1.3);
}

/// Returns the tiles of an app, with the trees in each.
fn tiles(app: &mut App) -> Vec<(Tile, Vec<u32>)> {
    let world = app.world_mut();
    let mut tiles = world.query::<(&Tile, &Children)>();
    let mut trees = world.query_filtered::<&PartId, With<Tree>>();
    let mut found = Vec::new();
    for (tile, children) in tiles.iter(world) {
        let own = trees.iter_many(world, children.iter()).map(|id| id.index);
        found.push((*tile, own.collect()));
    }
    found
}

fn by_hand(bare: &mut World, world: &EnvgenWorld, tiles: &[(Tile, Vec<u32>)]) {
    let settings = ColliderSettings::default();
    let root = bare.spawn(Transform::default()).id();
    let place = |index: u32| world.trees[index as usize].center.as_vec2();
    let radius = |index: u32| world.trees[index as usize].radius as f32;
    let spawned: Vec<Entity> = bare
        .spawn_batch(tiles.iter().map(|(tile, trees)| {
            let balls = trees.iter().map(|&i| (place(i), 0.0, Collider::ball(radius(i))));
            (
                *tile,
                Name::new(format!("tile ({}, {})", tile.at[0], tile.at[1])),
                ChildOf(root),
                Collider::compound(balls.collect()),
                settings.solid_groups,
                Friction::coefficient(settings.friction),
                Restitution::coefficient(settings.restitution),
            )
        }))
        .collect();
    for (tile, (_, trees)) in spawned.into_iter().zip(tiles) {
        bare.spawn_batch(trees.iter().map(|&index| {
            (
                PartId::new(PartKind::Tree, index),
                Name::new(format!("tree {index}")),
                ChildOf(tile),
                PartOf(root),
                Transform::from_translation(place(index).extend(0.0)),
                PartShape::Disc { radius: radius(index) },
                Tree { radius: radius(index) },
            )
        }));
    }
}

/// Measures the steps of rapier in a static world: merged colliders against one collider per tree, by the
/// plugin and hand-written with fixed bodies. The cost of the same app without a world is subtracted from
/// each.
fn resting(world: &Arc<EnvgenWorld>) {
    let app = |merge, solids| {
        let mut app = test_app();
        let colliders = EnvironmentColliders(ColliderSettings { merge, ..default() });
        let environment = Environment::prebuilt(Arc::clone(world)).with_solids(solids);
        let root = app.world_mut().spawn((environment, colliders)).id();
        if let Err(error) = wait_until_ready(&mut app, root) {
            say(&error.to_string());
        }
        let first = seconds(|| app.update());
        step(&mut app, 20);
        (app, first)
    };
    let (mut data, first_data) = app(ColliderMerging::Always, SolidStorage::TileData);
    let (mut merged, first) = app(ColliderMerging::Always, SolidStorage::Entities);
    let (mut single, first_single) = app(ColliderMerging::Never, SolidStorage::Entities);
    let mut empty = test_app();
    step(&mut empty, 20);
    let mut by_hand = test_app();
    by_hand.world_mut().spawn_batch(
        world
            .trees
            .iter()
            .map(|tree| {
                let place = Transform::from_translation(tree.center.as_vec2().extend(0.0));
                (place, RigidBody::Fixed, Collider::ball(tree.radius as f32))
            })
            .collect::<Vec<_>>(),
    );
    let first_by_hand = seconds(|| by_hand.update());
    step(&mut by_hand, 20);
    let mut times = [const { Vec::new() }; 5];
    for _ in 0..1000 {
        let apps = [&mut data, &mut merged, &mut single, &mut by_hand, &mut empty];
        for (app, times) in apps.into_iter().zip(&mut times) {
            times.push(seconds(|| app.update()));
        }
    }
    let [data, merged, single, by_hand, empty] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    let ms = |seconds: f64| format!("{:.3} ms", 1e3 * seconds);
    say(&format!(
        "  an update: as data {}, merged {}, one a tree {}, one a tree by hand {}, no world {}",
        ms(data),
        ms(merged),
        ms(single),
        ms(by_hand),
        ms(empty)
    ));
    for (what, at_rest, first) in
        [("as data", data, first_data), ("merged, entities", merged, first)]
    {
        let cost = (at_rest - empty, single - empty);
        at_most(&format!("a world at rest, {what}, against a collider per tree"), cost, 0.1);
        let cost = (at_rest - empty, by_hand - empty);
        at_most(&format!("a world at rest, {what}, against bodies by hand"), cost, 0.1);
        let times = (first, first_single);
        at_most(&format!("the first update, {what}, against a collider per tree"), times, 0.1);
        let times = (first, first_by_hand);
        at_most(&format!("the first update, {what}, against bodies by hand"), times, 0.1);
    }
}

/// Measures an anchor that moves at 20 m/s through an endless forest of 0.05 trees per square metre.
fn streaming() {
    const SPEED: f32 = 20.0;
    const FRAMES: usize = 2000;
    const RADIUS: f64 = 60.0;
    let budget = Duration::from_millis(2);
    let mut app = test_app();
    app.insert_resource(StreamingBudget::Time(budget));
    let anchor = app.world_mut().spawn(Transform::default()).id();
    let spec = ForestSpec { intensity: 0.05, radius: 0.3, ..default() };
    let environment = Environment::new(spec, 1).endless(15.0);
    let root = app.world_mut().spawn((environment, StreamAround::new(anchor, RADIUS))).id();
    if let Err(error) = wait_until_ready(&mut app, root) {
        say(&error.to_string());
    }
    let (mut times, mut late, mut tiles) = (Vec::with_capacity(FRAMES), 0, 0);
    let start = std::time::Instant::now();
    for _ in 0..FRAMES {
        if let Some(mut at) = app.world_mut().get_mut::<Transform>(anchor) {
            at.translation.x += SPEED / 64.0;
        }
        app.update();
        let report = *app.world().resource::<StreamingReport>();
        times.push(report.time.as_secs_f64());
        late += usize::from(report.waiting > 0);
        tiles += report.spawned;
    }
    let frames = start.elapsed().as_secs_f64();
    times.sort_by(f64::total_cmp);
    let simulated = FRAMES as f64 / 64.0;
    say(&format!(
        "  {tiles} tiles in {FRAMES} frames, {late} frames ended with tiles missing; median {:.1} us, \
         99.9 % {:.0} us, longest {:.0} us",
        1e6 * times[FRAMES / 2],
        1e6 * times[FRAMES - 1 - FRAMES / 1000],
        1e6 * times[FRAMES - 1],
    ));
    let budget = budget.as_secs_f64();
    at_most("the longest frame of streaming, against its budget", (times[FRAMES - 1], budget), 1.0);
    at_most("frames that end with tiles missing, against all", (late as f64, FRAMES as f64), 0.0);
    at_most("all frames together, against the time they simulate", (frames, simulated), 1.0);
}
