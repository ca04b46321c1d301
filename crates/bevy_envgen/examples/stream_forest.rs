//! An endless forest that is streamed around a moving anchor.
//!
//! `cargo run --release --example stream_forest`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use bevy::prelude::*;
use bevy_envgen::prelude::*;
use bevy_envgen::{StreamingReport, Tile};

/// The length of the path of the walker in metres, and its step in each frame.
const WAY: f32 = 300.0;
const STEP: f32 = 1.0;

#[derive(Component)]
struct Walker;

/// A resource with the numbers of tile entities that were spawned and despawned so far.
#[derive(Resource, Default)]
struct Totals {
    spawned: usize,
    despawned: usize,
}

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()))
        // The budget counts parts instead of time, so that every run spawns the same tiles in the same
        // frames.
        .insert_resource(StreamingBudget::Parts(500))
        .init_resource::<Totals>()
        .add_systems(Startup, ask_for_forest)
        .add_systems(Update, walk.before(EnvgenSystems::Request))
        .add_systems(Update, report.after(EnvgenSystems::Notify))
        .run()
}

fn ask_for_forest(mut commands: Commands) {
    let walker = commands.spawn((Walker, Transform::default())).id();
    let forest = ForestSpec { intensity: 0.05, radius: 0.3, ..default() };
    // Tiles have a side of 12 m, and everything within 40 m of the walker is spawned.
    commands.spawn((Environment::new(forest, 7).endless(12.0), StreamAround::new(walker, 40.0)));
}

fn walk(mut walker: Single<&mut Transform, With<Walker>>) {
    walker.translation.x += STEP;
}

/// Prints what is spawned every 50 m, and ends the app at the end of the path.
fn report(
    walker: Single<&Transform, With<Walker>>,
    streaming: Res<StreamingReport>,
    mut totals: ResMut<Totals>,
    tiles: Query<&Tile>,
    trees: Query<&Tree>,
    mut exit: MessageWriter<AppExit>,
) {
    totals.spawned += streaming.spawned;
    totals.despawned += streaming.despawned;
    let x = walker.translation.x;
    if x % 50.0 == 0.0 {
        let (tiles, trees) = (tiles.iter().count(), trees.iter().count());
        let Totals { spawned, despawned } = *totals;
        println!("x = {x} m: {tiles} tiles of {trees} trees; {spawned} spawned, {despawned} gone");
    }
    if x >= WAY {
        // The tiles behind the walker are despawned, and those around the walker are spawned.
        let streamed =
            totals.despawned > 0 && totals.spawned - totals.despawned == tiles.iter().count();
        exit.write(if streamed { AppExit::Success } else { AppExit::error() });
    }
}
