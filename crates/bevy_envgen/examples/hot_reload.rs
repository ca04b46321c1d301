//! A hallway whose spec is a file: the world is rebuilt when the file changes.
//!
//! In this repository `cargo run --release --example hot_reload`; elsewhere it needs
//! `--features file_watcher`.

#![expect(clippy::print_stdout, reason = "the output of an example")]

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy_envgen::prelude::*;

/// The seconds after which an undetected change is an error.
const PATIENCE: f32 = 60.0;

#[derive(Resource)]
struct SpecFile(PathBuf);

fn main() -> Result<AppExit> {
    // The folder is deleted when `main` returns.
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("hall.envgen.ron");
    fs::write(&file, "Hallway(segments: 20)")?;
    let file_path = folder.path().to_string_lossy().into_owned();

    // Files are loaded and watched by other threads, in real time.
    let runner = ScheduleRunnerPlugin::run_loop(Duration::from_millis(10));
    let exit = App::new()
        .add_plugins((MinimalPlugins.set(runner), AssetPlugin { file_path, ..default() }))
        .add_plugins((TransformPlugin, EnvgenPlugins::default()))
        .insert_resource(SpecFile(file))
        .add_systems(Startup, load)
        .add_systems(Update, give_up)
        .add_observer(change_file)
        .add_observer(|failed: On<EnvironmentFailed>| println!("{}", failed.error))
        .run();
    Ok(exit)
}

fn load(assets: Res<AssetServer>, mut commands: Commands) {
    commands.spawn(Environment::from_asset(assets.load("hall.envgen.ron"), 7));
}

/// Rewrites the file when its first world is ready, and ends the app when the second one is.
fn change_file(
    ready: On<EnvironmentReady>,
    worlds: Query<&GroundTruth>,
    file: Res<SpecFile>,
    mut first: Local<Option<usize>>,
    mut exit: MessageWriter<AppExit>,
) -> Result {
    let walls = worlds.get(ready.entity)?.walls.len();
    println!("{} gives {walls} walls", fs::read_to_string(&file.0)?);
    if let Some(first) = *first {
        exit.write(if walls > first { AppExit::Success } else { AppExit::error() });
    } else {
        *first = Some(walls);
        fs::write(&file.0, "Hallway(segments: 60)")?;
    }
    Ok(())
}

fn give_up(time: Res<Time<Real>>, mut exit: MessageWriter<AppExit>) {
    if time.elapsed_secs() > PATIENCE {
        println!("no change was noticed in {PATIENCE} s");
        exit.write(AppExit::error());
    }
}
