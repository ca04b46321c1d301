//! Opens a window in which a person drives a robot, maps a world that they do not know, fills in the
//! feedback form, and sees the scores.
//!
//! ```text
//! cargo run --release --features window --example teleop
//! cargo run --release --features window --example teleop -- --difficulty 8 --seed 3 --robots 2
//! cargo run --release --features window --example teleop -- --set doors=0.5 --set people=4 --training
//! cargo run --release --features window --example teleop -- --policy corridors
//! cargo run --release --features window --example mapping_trial -- --replay out/teleop/001/log.json --out out/again
//! ```
//!
//! W, A, S, D, the arrows or a gamepad (feature `gamepad`) drive. Tab switches to the next robot, P or
//! Esc pauses, R restarts, C makes the robot's camera or the map large, T shows the true world, + and -
//! zoom, and End ends the trial. `--no-camera` is for machines that are too slow for the cameras.
//!
//! The folder `--out` then holds a folder for every trial, with the files of `mapping_trial`: the log,
//! the report with the form, pictures, and the map for ROS.

mod arguments;
mod cameras;
mod compare;
mod draft;
mod frame_log;
mod keys;
#[path = "../shared/moving.rs"]
mod moving;
#[path = "../shared/output.rs"]
mod output;
#[path = "../shared/pace.rs"]
mod pace;
mod panels;
mod pictures;
#[path = "../shared/robot.rs"]
mod robot;
mod robot_cameras;
#[path = "../shared/samples.rs"]
mod samples;
mod saving;
mod session;
#[path = "../shared/spec_file.rs"]
mod spec_file;
#[path = "../shared/start.rs"]
mod start;
#[path = "../shared/trial_arguments.rs"]
mod trial_arguments;
#[path = "../shared/window.rs"]
mod window;

use std::error::Error;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_envgen::physics::{ColliderSettings, EnvgenPhysicsPlugin, TopDownPhysicsPlugin};
use bevy_envgen::visuals::EnvgenVisualsPlugin;
use bevy_envgen::visuals3d::{EnvgenVisuals3dPlugin, Visuals3dSettings};
use bevy_envgen::{EnvgenCorePlugin, EnvgenScenarioPlugin};
use bevy_mapping_trial::debug::TrialDebugPlugin;
use bevy_mapping_trial::trial::{ForTrials, TrialPlugin, TrialSystems};
use bevy_mapping_trial::ui::bevy_egui::input::egui_wants_any_keyboard_input;
use bevy_mapping_trial::ui::bevy_egui::{EguiPlugin, EguiPreUpdateSet, EguiPrimaryContextPass};
use bevy_mapping_trial::view::TrialViewPlugin;
use bevy_mapping_trial::view3d::RobotVisuals3dPlugin;
use clap::Parser;
use envgen::located::Locate;

use crate::arguments::Arguments;
use crate::frame_log::FrameLog;
use crate::session::Session;

fn main() -> ExitCode {
    window::exit_code(run(&Arguments::parse()))
}

/// Opens the window. Errors in the command line are reported before.
fn run(arguments: &Arguments) -> Result<AppExit, Box<dyn Error>> {
    let beginning = arguments.beginning()?;
    let settings = (arguments.settings()?, arguments.scenario()?);
    output::folder(&arguments.out)?;
    let _display = window::find_display()?;
    let frame_log = arguments.frame_log.as_deref().map(|path| {
        FrameLog::create(path, &arguments.inputs()).in_option("--frame-log", path.display())
    });

    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(window::titled("envgen: drive")),
        EguiPlugin::default(),
        EnvgenCorePlugin::default(),
        EnvgenScenarioPlugin::default(),
        TopDownPhysicsPlugin::for_trials(),
        EnvgenPhysicsPlugin::default().with_colliders(ColliderSettings::for_trials()),
        TrialPlugin::default(),
        EnvgenVisualsPlugin::default(),
        TrialViewPlugin::default(),
        TrialDebugPlugin,
        pace::let_panels_rest,
    ));
    if arguments.has_cameras() {
        let rooms = Visuals3dSettings { ceilings: true, shadows: false, ..default() };
        let rows = arguments.camera_rows;
        app.add_plugins((EnvgenVisuals3dPlugin::new(rooms), RobotVisuals3dPlugin))
            .add_observer(robot_cameras::equip)
            .add_systems(Startup, (move || rows).pipe(robot_cameras::spawn_pictures))
            .add_systems(FixedUpdate, robot_cameras::note_poses.after(TrialSystems::Record))
            .add_systems(Update, robot_cameras::look);
    }
    let session = Session::new(arguments, beginning, settings, app.world_mut());
    app.insert_resource(session)
        .add_observer(session::world_is_ready)
        .add_observer(session::world_has_failed)
        .add_observer(session::trial_has_ended)
        .add_observer(session::trial_has_failed)
        .add_systems(Startup, cameras::spawn)
        .add_systems(
            PreUpdate,
            keys::keep_tab
                .after(EguiPreUpdateSet::ProcessInput)
                .before(EguiPreUpdateSet::BeginPass),
        )
        .add_systems(
            RunFixedMainLoop,
            (session::halt, keys::steer).in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        )
        .add_systems(FixedUpdate, session::count.after(TrialSystems::Record))
        .add_systems(
            Update,
            (
                keys::zoom,
                keys::act.run_if(not(egui_wants_any_keyboard_input)),
                cameras::follow_driven,
                cameras::fit,
                session::poll,
                session::hide_lines,
                session::activity.pipe(pace::pace),
            )
                .chain(),
        )
        .add_systems(EguiPrimaryContextPass, (panels::panels, pictures::show).chain())
        .add_systems(
            Last,
            (session::save_at_exit, frame_log::write.run_if(resource_exists::<FrameLog>)).chain(),
        );
    if let Some(frame_log) = frame_log {
        app.insert_resource(frame_log?);
    }
    Ok(app.run())
}
