//! Draws every kind of world, and films mapping trials (from above and as a robot sees them), people,
//! doors and smoke, without a window.
//!
//! `cargo run --release --features render --example gallery`
//!
//! It needs a graphics card with a Vulkan, Metal or DirectX driver, or Mesa's software Vulkan.

mod eyes;
mod height;
#[path = "../../crates/mapping_trial/src/bin/envgen-trials/spinner.rs"]
mod spinner;
#[path = "../shared/trial_bar.rs"]
mod trial_bar;
mod worlds;

use std::path::{Path, PathBuf};
use std::time::Duration;

use bevy::prelude::*;
use bevy_envgen::prelude::{
    ColliderSettings, EnvgenPhysicsPlugin, EnvgenPlugins, Environment, EnvironmentFailure,
    EnvironmentScenario, GenerationMode, GroundTruth, TopDownPhysicsPlugin,
};
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::view::{TrialPalette, TrialView, TrialViewPlugin};
use bevy_offscreen::{CapturedImage, Film, Studio, find_renderer};
use clap::Parser;
use clap::builder::PossibleValuesParser;
use envgen::indoor::IndoorSpec;
use envgen::scenario::Scenario;
use envgen::{Seed, WorldSpec};
use mapping_trial::backend::TICK;
use mapping_trial::trial::{Trial, TrialSettings};

use crate::spinner::spinner;
use crate::trial_bar::trial_bar;
use crate::worlds::{FILM_SEED, corridor, spec};

/// Width and height of the pictures in pixels.
const SIZE: UVec2 = UVec2::new(800, 600);

/// Side of the map in the film of a trial, in grid units of 3 m.
const FILM_MAP: u32 = 6;

/// A film of a trial.
struct Take {
    /// Width and height in pixels.
    size: UVec2,
    /// Content of the film.
    view: TrialView,
    /// Time limit in simulated seconds.
    time_limit: f64,
    /// Simulated time from frame to frame in ticks of 50 ms, and frames per second.
    ticks_per_frame: u32,
    frames_per_second: f64,
}

/// A trial as its driver sees it.
const TRIAL: Take = Take {
    size: UVec2::new(480, 480),
    view: TrialView { truth: false, map: true, scan: true, path: true },
    time_limit: 1200.0,
    ticks_per_frame: 50,
    frames_per_second: 12.5,
};

/// A corridor in its true state, with the robot's laser.
const CORRIDOR: Take = Take {
    size: UVec2::new(640, 200),
    view: TrialView { truth: true, map: false, scan: true, path: false },
    time_limit: 30.0,
    ticks_per_frame: 4,
    frames_per_second: 10.0,
};

/// Draws every kind of world, films mapping trials from above and through the eyes of a robot, and films people, doors
/// and smoke, without a window.
#[derive(Parser)]
struct Arguments {
    /// The folder to write into.
    #[arg(long, default_value = "docs/gallery")]
    out: PathBuf,
    /// Names of pictures and films to make, in place of all.
    #[arg(long, num_args = 1.., value_name = "NAME", value_parser = PossibleValuesParser::new(names()))]
    only: Vec<String>,
}

impl Arguments {
    /// Returns the file of a picture or film, if it is to be made.
    fn wanted(&self, name: &str, extension: &str) -> Option<PathBuf> {
        let is_wanted = self.only.is_empty() || self.only.iter().any(|only| only == name);
        is_wanted.then(|| self.out.join(format!("{name}.{extension}")))
    }
}

/// A picture: its name, the kind of world, its settings and a seed.
type Sketch = (&'static str, &'static str, &'static [(&'static str, &'static str)], u64);

/// The pictures, with every kind of world.
const WORLDS: &[Sketch] = &[
    ("hallway", "hallway", &[("segments", "14"), ("p_st", "0.4"), ("door_frame_rate", "0.1")], 7),
    (
        "forest",
        "forest",
        &[
            ("width", "40"),
            ("height", "30"),
            ("min_distance", "1.5"),
            ("intensity", "0.15"),
            ("radius", "0.5"),
        ],
        2,
    ),
    ("road", "road", &[], 2),
    ("indoor", "indoor", &[("difficulty", "5"), ("width", "16"), ("height", "12")], 4),
    (
        "landscape",
        "landscape",
        &[("algorithm", "smooth"), ("entropy", "1.9"), ("total_edge", "700")],
        3,
    ),
];

/// The films: a trial, people in a corridor, and what a robot sees.
const FILMS: [&str; 3] = ["trial", "moving", "robot_camera"];

/// Returns the names of all pictures and films.
fn names() -> impl Iterator<Item = &'static str> {
    let worlds = WORLDS.iter().map(|&(name, ..)| name);
    worlds.chain(height::SCENES.iter().map(|scene| scene.name)).chain(FILMS)
}

fn main() -> std::process::ExitCode {
    match gallery(&Arguments::parse()) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "errors belong on stderr")]
            {
                eprintln!("error: {error}");
            }
            std::process::ExitCode::FAILURE
        }
    }
}

#[expect(clippy::print_stdout, reason = "the output of an example")]
fn gallery(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    println!("drawing by {}", find_renderer()?);
    std::fs::create_dir_all(&arguments.out)?;
    for &(name, kind, settings, seed) in WORLDS {
        let Some(path) = arguments.wanted(name, "png") else { continue };
        let drawing = spinner(name);
        draw(spec(kind, settings)?, seed)?.write_png(&path)?;
        drawing.finish_and_clear();
        println!("wrote {}", path.display());
    }
    for scene in height::SCENES {
        let Some(path) = arguments.wanted(scene.name, "png") else { continue };
        let drawing = spinner(scene.name);
        height::draw(scene)?.write_png(&path)?;
        drawing.finish_and_clear();
        println!("wrote {}", path.display());
    }
    let [trial, moving, robot_camera] = FILMS;
    if let Some(path) = arguments.wanted(trial, "gif") {
        let spec = IndoorSpec { width: FILM_MAP, height: FILM_MAP, ..Default::default() };
        let trial = film(&path, &TRIAL, Environment::new(spec, FILM_SEED), None)?;
        println!("wrote {}, a trial of {trial:.0} simulated seconds", path.display());
    }
    if let Some(path) = arguments.wanted(moving, "gif") {
        let (world, moving) = corridor();
        film(&path, &CORRIDOR, Environment::prebuilt(world), Some(moving))?;
        println!("wrote {}, people, a door and smoke in a corridor", path.display());
    }
    if let Some(path) = arguments.wanted(robot_camera, "gif") {
        let seconds = eyes::film(&path)?;
        println!("wrote {}, {seconds:.0} simulated seconds through a robot's eyes", path.display());
    }
    Ok(())
}

/// Spawns a world, and a camera that shows all of it.
fn spawn(
    studio: &mut Studio,
    environment: Environment,
    size: UVec2,
) -> Result<(Entity, Entity), Box<dyn std::error::Error>> {
    let environment = environment.with_pace(GenerationMode::Blocking);
    let world = studio.app().world_mut().spawn(environment.clone()).id();
    // After a frame the world exists.
    studio.step()?;
    let root = studio.app().world().entity(world);
    if let Some(failure) = root.get::<EnvironmentFailure>() {
        return Err(failure.0.clone().into());
    }
    let frame = root.get::<GlobalTransform>().copied().unwrap_or_default();
    let truth = root.get::<GroundTruth>().ok_or("the world is not ready")?;
    let area = environment.area_in_app(&frame, truth.bounds);
    Ok((world, studio.camera(area, size)?))
}

/// Draws a world as the plugin does.
fn draw(spec: WorldSpec, seed: u64) -> Result<CapturedImage, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    studio.app().add_plugins(EnvgenPlugins::default()).insert_resource(ClearColor(Color::WHITE));
    let (_, camera) = spawn(&mut studio, Environment::new(spec, seed), SIZE)?;
    Ok(studio.picture(camera)?)
}

/// Films a mapping trial from start to end. Returns the simulated time in seconds.
fn film(
    path: &Path,
    take: &Take,
    environment: Environment,
    moving: Option<Scenario>,
) -> Result<f64, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    // All ticks of a frame run in one step.
    let frame_time = Duration::from_secs_f64(TICK) * take.ticks_per_frame;
    studio.set_frame_time(frame_time);
    let colliders = ColliderSettings::for_trials();
    studio
        .app()
        .add_plugins((
            TopDownPhysicsPlugin::for_trials(),
            EnvgenPlugins::default().set(EnvgenPhysicsPlugin::default().with_colliders(colliders)),
            TrialPlugin::default(),
            TrialViewPlugin::default(),
        ))
        .insert_resource(ClearColor(TrialPalette::default().unknown));
    let (world, camera) = spawn(&mut studio, environment, take.size)?;
    studio.app().world_mut().resource_mut::<Time<Virtual>>().set_max_delta(frame_time);
    // Nothing needs to be drawn between pictures.
    if let Some(mut camera) = studio.app().world_mut().get_mut::<Camera>(camera) {
        camera.is_active = false;
    }
    let time_limit = take.time_limit;
    let settings = TrialSettings { seed: Seed(FILM_SEED), time_limit, ..Default::default() };
    let mut root = studio.app().world_mut().entity_mut(world);
    if let Some(moving) = moving {
        root.insert(EnvironmentScenario::prebuilt(moving));
    }
    root.insert((MappingTrial::new(settings), take.view));

    let bar = trial_bar(take.time_limit);
    let mut film = Film::create(path, take.frames_per_second)?;
    loop {
        studio.step()?;
        film.push(&studio.picture(camera)?)?;
        let trial = studio.app().world().get::<MappingTrial>(world);
        let trial = trial.filter(|trial| !trial.has_failed()).ok_or("the trial cannot begin")?;
        let seconds = trial.trial().map_or(0.0, Trial::time);
        bar.set_position(seconds as u64);
        if trial.is_over() {
            film.finish()?;
            bar.finish_and_clear();
            return Ok(seconds);
        }
    }
}
