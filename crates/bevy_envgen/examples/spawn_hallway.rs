//! A seeded hallway as entities, in an app without a window.
//!
//! `cargo run --release --example spawn_hallway`

#![expect(clippy::print_stdout, reason = "the output of an example")]

use bevy::prelude::*;
use bevy_envgen::prelude::*;

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()))
        .add_systems(Startup, ask_for_hallway)
        .add_observer(report)
        .add_observer(give_up)
        .run()
}

fn ask_for_hallway(mut commands: Commands) {
    let spec = HallwaySpec { segments: 80, p_st: 0.2, ..default() };
    commands.spawn(Environment::new(spec, 7));
}

/// Reports the hallway. All its parts are spawned at this time.
fn report(
    ready: On<EnvironmentReady>,
    worlds: Query<&EnvironmentLandmarks>,
    walls: Query<&PartOf, With<Wall>>,
    mut exit: MessageWriter<AppExit>,
) -> Result {
    let count = walls.iter().filter(|part| part.0 == ready.entity).count();
    println!("the hallway has {count} walls");
    let start = worlds.get(ready.entity)?.start.ok_or("the hallway has no start")?;
    println!("a robot can start at {:.2}", start.pose.translation.truncate());
    exit.write(if count > 0 { AppExit::Success } else { AppExit::error() });
    Ok(())
}

fn give_up(failed: On<EnvironmentFailed>, mut exit: MessageWriter<AppExit>) {
    println!("there is no hallway: {}", failed.error);
    exit.write(AppExit::error());
}
