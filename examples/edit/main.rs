//! Opens a window in which worlds are edited: rooms, hallways and doorways of indoor maps, and the
//! parts of any other world.
//!
//! ```text
//! cargo run --release --features window --example edit -- indoor --seed 3
//! cargo run --release --features window --example edit -- out/edit/indoor_3.xml
//! cargo run --release --features window --example edit -- forest --seed 2 --set width=20
//! ```
//!
//! The keys 1 to 5 choose a tool: select and move, room, hallway, doorway, object. R turns, Delete
//! removes, Ctrl+Z undoes, Ctrl+Shift+Z and Ctrl+Y redo, and Ctrl+S saves. T opens the world in a
//! trial, V tilts the plan, Q and E turn the tilted plan, G shows the grid, F shows everything, Esc
//! stops, and Ctrl+Q closes. The wheel zooms; dragging with the middle or right button moves the plan.

mod arguments;
mod auditing;
mod canvas;
mod floors;
mod keys;
#[path = "../shared/pace.rs"]
mod pace;
mod painting;
mod panels;
#[path = "../shared/samples.rs"]
mod samples;
mod saving;
mod session;
#[path = "../shared/spec_file.rs"]
mod spec_file;
mod tools;
mod trial;
mod view;
#[path = "../shared/window.rs"]
mod window;

use std::error::Error;
use std::process::ExitCode;

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{CameraOutputMode, ClearColorConfig};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::render_resource::BlendState;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_envgen::prelude::{EnvgenVisuals3dPlugin, Visuals3dSettings};
use bevy_envgen::visuals::EnvgenVisualsPlugin;
use bevy_envgen::{EnvgenCorePlugin, EnvgenSystems};
use bevy_mapping_trial::ui::bevy_egui::{
    EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext,
};
use clap::Parser;

use crate::arguments::Arguments;
use crate::pace::{Activity, let_panels_rest, pace};
use crate::samples::samples;
use crate::session::Session;
use crate::view::WorldCamera;

/// Colour where the world is solid ground, or ends.
const GROUND: Color = Color::srgb(0.80, 0.81, 0.83);

fn main() -> ExitCode {
    window::exit_code(run(&Arguments::parse()))
}

/// Opens the window. Errors in the command line are reported before.
fn run(arguments: &Arguments) -> Result<AppExit, Box<dyn Error>> {
    let opened = arguments.open()?;
    let _display = window::find_display()?;
    // The session closes the window, once changes are saved or discarded.
    let window = WindowPlugin { close_when_requested: false, ..window::titled("envgen: edit") };
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(window),
        EguiPlugin::default(),
        EnvgenCorePlugin::default(),
        EnvgenVisualsPlugin::default(),
        EnvgenVisuals3dPlugin::new(Visuals3dSettings { sky: false, ..default() }),
        let_panels_rest,
    ))
    .insert_resource(Session::new(opened))
    .add_observer(session::show_failure)
    .add_systems(Startup, spawn_cameras)
    .add_systems(
        Update,
        // The world is drawn in the same frame in which it changes.
        (
            keys::act,
            session::poll,
            session::show.before(EnvgenSystems::Request),
            floors::lay,
            session::follow,
            activity.pipe(pace),
            session::close,
        )
            .chain(),
    )
    .add_systems(EguiPrimaryContextPass, panels::panels);
    Ok(app.run())
}

/// Reasons for which the window changes without inputs.
fn activity(session: Res<Session>) -> Activity {
    Activity { moves: false, computes: session.auditing.is_running() }
}

/// Spawns the camera of the world, and that of the panels over it.
fn spawn_cameras(
    adapter: Res<RenderAdapterInfo>,
    mut settings: ResMut<EguiGlobalSettings>,
    mut commands: Commands,
) {
    settings.auto_create_primary_context = false;
    let around = || Camera { clear_color: ClearColorConfig::Custom(GROUND), ..default() };
    let samples = samples(&adapter);
    commands.spawn((Camera2d, samples, WorldCamera::Plan, around()));
    commands.spawn((
        Camera3d::default(),
        WorldCamera::Tilted,
        Camera { is_active: false, ..around() },
        samples,
        Projection::Orthographic(OrthographicProjection::default_3d()),
        Tonemapping::KhronosPbrNeutral,
    ));
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        samples,
        RenderLayers::none(),
        Camera {
            order: 1,
            output_mode: CameraOutputMode::Write {
                // The colours of egui are premultiplied by their opacity.
                blend_state: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                clear_color: ClearColorConfig::None,
            },
            clear_color: ClearColorConfig::Custom(Color::NONE),
            ..default()
        },
    ));
}
