//! A window to walk through a world, in first person or from behind.
//!
//! ```text
//! cargo run --release --features window --example walk -- indoor --seed 3
//! cargo run --release --features window --example walk -- indoor --set doors=0.5 --set people=8 --set smoke=0.2
//! cargo run --release --features window --example walk -- forest --set intensity=0.05
//! cargo run --release --features window --example walk -- assets/worlds/thesis_indoor.envgen.ron
//! ```
//!
//! W, A, S, D walk, Shift runs, the mouse looks around once it was clicked, the left and right arrows turn too. V
//! switches between the views, Esc frees the mouse.

mod arguments;
mod walker;

use std::error::Error;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_envgen::physics::TopDownPhysicsPlugin;
use bevy_envgen::prelude::{
    EnvgenCorePlugin, EnvgenPhysicsPlugin, EnvgenScenarioPlugin, EnvgenVisuals3dPlugin,
    Environment, EnvironmentScenario, GenerationMode, Visuals3dSettings,
};
use bevy_offscreen::find_renderer;
use clap::Parser;

use crate::arguments::Arguments;

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(AppExit::Success) => ExitCode::SUCCESS,
        Ok(AppExit::Error(code)) => ExitCode::from(code.get()),
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "errors belong on stderr")]
            {
                eprintln!("error: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Opens the window. Mistakes in the command line are reported before.
fn run(arguments: &Arguments) -> Result<AppExit, Box<dyn Error>> {
    let (world, moving) = arguments.world()?;
    let start = walker::start(&world)?;
    // Without a graphics driver Bevy would panic.
    find_renderer()?;
    let window = Window { title: "envgen: walk".to_owned(), ..default() };
    let window = WindowPlugin { primary_window: Some(window), ..default() };
    let settings = Visuals3dSettings { ceilings: true, ..default() };
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(window),
        EnvgenCorePlugin::default(),
        EnvgenScenarioPlugin::default(),
        TopDownPhysicsPlugin::default(),
        EnvgenPhysicsPlugin::default(),
        EnvgenVisuals3dPlugin::new(settings),
    ));
    let environment = Environment::prebuilt(world).with_pace(GenerationMode::Blocking);
    let mut root = app.world_mut().spawn(environment);
    if let Some(moving) = moving {
        root.insert(EnvironmentScenario::prebuilt(moving));
    }
    app.world_mut().spawn(walker::body(start));
    app.world_mut().spawn(walker::camera());
    app.add_systems(
        Update,
        (walker::hold_mouse, walker::look, walker::walk, walker::follow).chain(),
    );
    Ok(app.run())
}
