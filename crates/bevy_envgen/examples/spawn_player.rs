//! Spawns a player at the start of each of two worlds, wherever the worlds are placed:
//!
//! ```sh
//! cargo run --release --example spawn_player
//! ```

use bevy::prelude::*;
use bevy_envgen::prelude::*;

#[derive(Component)]
struct Player;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
    app.add_systems(Startup, ask_for_worlds).add_observer(spawn_player);
    // Or `app.run()`.
    app.finish();
    app.cleanup();
    app.update();
}

fn ask_for_worlds(mut commands: Commands) {
    let turned = Transform::from_xyz(0.0, 100.0, 0.0).with_rotation(Quat::from_rotation_z(1.0));
    commands.spawn((Name::new("hallway"), Environment::new(HallwaySpec::default(), 7)));
    commands.spawn((Name::new("forest"), Environment::new(ForestSpec::default(), 7), turned));
}

/// Spawns a player. The entity of the event has the start of its world, in global coordinates of the app.
#[expect(clippy::print_stdout, reason = "the output of an example")]
fn spawn_player(
    ready: On<EnvironmentReady>,
    worlds: Query<(&Name, &EnvironmentLandmarks)>,
    mut commands: Commands,
) -> Result {
    let (name, landmarks) = worlds.get(ready.entity)?;
    if let Some(start) = landmarks.start {
        commands.spawn((Player, start.pose));
        println!("a player in the {name} at {:.2}", start.pose.translation.truncate());
    }
    Ok(())
}
