//! Opens a window in which one walks through a world, in first person or seen from behind.
//!
//! ```text
//! cargo run --release --features window --example walk -- indoor --seed 3
//! cargo run --release --features window --example walk -- indoor --set doors=0.5 --set people=8 --set smoke=0.2
//! cargo run --release --features window --example walk -- forest --set intensity=0.05
//! cargo run --release --features window --example walk -- assets/worlds/thesis_indoor.envgen.ron
//! ```
//!
//! W, A, S, D walk, and Shift runs. After a click the mouse looks around; the left and right arrows
//! turn as well. V switches between the views, and Esc frees the mouse.

mod arguments;
#[path = "../shared/samples.rs"]
mod samples;
#[path = "../shared/spec_file.rs"]
mod spec_file;
mod walker;
#[path = "../shared/window.rs"]
mod window;

use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;

use bevy::prelude::*;
use bevy_envgen::bevy_rapier2d::plugin::PhysicsSet;
use bevy_envgen::physics::TopDownPhysicsPlugin;
use bevy_envgen::prelude::{
    EnvgenCorePlugin, EnvgenPhysicsPlugin, EnvgenScenarioPlugin, EnvgenVisuals3dPlugin,
    Environment, EnvironmentScenario, GenerationMode, StreamAround, Visuals3dSettings,
};
use clap::Parser;

use crate::arguments::Arguments;

/// In worlds with more parts than this, only what is near is drawn...
const MANY_PARTS: usize = 50_000;

/// ...up to this distance in metres.
const SIGHT: f64 = 100.0;

/// The title of the window, with the keys.
const TITLE: &str = "envgen: walk (W A S D, Shift, mouse or arrows; V: view, Esc: free the mouse)";

fn main() -> ExitCode {
    window::exit_code(run(&Arguments::parse()))
}

/// Opens the window. Errors in the command line are reported before.
fn run(arguments: &Arguments) -> Result<AppExit, Box<dyn Error>> {
    let (world, moving) = arguments.world()?;
    let start = walker::start(&world)?;
    let _display = window::find_display()?;
    let settings = Visuals3dSettings { ceilings: true, ..default() };
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(window::titled(TITLE)),
        EnvgenCorePlugin::default(),
        EnvgenScenarioPlugin::default(),
        TopDownPhysicsPlugin::default(),
        EnvgenPhysicsPlugin::default(),
        EnvgenVisuals3dPlugin::new(settings),
    ));
    let is_large = world.part_count() > MANY_PARTS;
    let world = Arc::new(world);
    let environment = Environment::prebuilt(Arc::clone(&world))
        .with_pace(GenerationMode::Blocking)
        .with_origin_near(&world);
    let walker = walker::body(start, environment.origin, walker::highest(&world));
    let walker = app.world_mut().spawn(walker).id();
    let mut root = app.world_mut().spawn(environment);
    if is_large {
        root.insert(StreamAround::new(walker, SIGHT));
    }
    if let Some(moving) = moving {
        root.insert(EnvironmentScenario::prebuilt(moving));
    }
    app.add_systems(Startup, walker::spawn_camera);
    app.add_systems(FixedUpdate, walker::note_place.after(PhysicsSet::Writeback));
    app.add_systems(
        Update,
        (walker::hold_mouse, walker::look, walker::walk, walker::follow).chain(),
    );
    Ok(app.run())
}
