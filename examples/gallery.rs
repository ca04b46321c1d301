//! Draws every kind of world and films a mapping trial, without a window.
//!
//! `cargo run --release --features render --example gallery`
//!
//! Needs a graphics card with a Vulkan, Metal or DirectX driver, or Mesa's software Vulkan.

use std::path::{Path, PathBuf};
use std::time::Duration;

use bevy::prelude::*;
use bevy_envgen::envgen::indoor::IndoorSpec;
use bevy_envgen::envgen::{Seed, WorldKind, WorldSpec};
use bevy_envgen::prelude::*;
use bevy_mapping_trial::prelude::*;
use bevy_mapping_trial::view::{TrialPalette, TrialViewPlugin};
use bevy_offscreen::{Film, Picture, Studio, find_renderer};
use clap::Parser;
use mapping_trial::backend::TICK;
use mapping_trial::trial::{Trial, TrialSettings};

/// Width and height of the pictures in pixels.
const SIZE: UVec2 = UVec2::new(800, 600);

/// Side of the map of the film in grid units of 3 m, and its seed.
const FILM_MAP: u32 = 6;
const FILM_SEED: u64 = 2;

/// Width and height of the film in pixels.
const FILM_SIZE: UVec2 = UVec2::new(480, 480);

/// Simulated time from frame to frame in ticks of 50 ms, and frames per second of the film.
const TICKS_PER_FRAME: u32 = 50;
const FRAMES_A_SECOND: f64 = 12.5;

/// Draws every kind of world and films a mapping trial, without a window.
#[derive(Parser)]
struct Arguments {
    /// The folder to write into.
    #[arg(long, default_value = "docs/gallery")]
    out: PathBuf,
}

/// A picture: its name, the kind of world, its settings and a seed.
type Sketch = (&'static str, &'static str, &'static [(&'static str, &'static str)], u64);

/// Every kind of world.
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
        let mut spec = kind.parse::<WorldKind>()?.default_spec();
        for (setting, value) in settings {
            spec.set(setting, value)?;
        }
        let path = arguments.out.join(format!("{name}.png"));
        draw(spec, seed)?.write_png(&path)?;
        println!("wrote {}", path.display());
    }
    let path = arguments.out.join("trial.gif");
    let trial = film(&path)?;
    println!("wrote {}, a trial of {trial:.0} simulated seconds", path.display());
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
    // After a frame the world is there.
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

/// A picture of a world as the plugin draws it.
fn draw(spec: WorldSpec, seed: u64) -> Result<Picture, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    studio.app().add_plugins(EnvgenPlugins::default()).insert_resource(ClearColor(Color::WHITE));
    let (_, camera) = spawn(&mut studio, Environment::new(spec, seed), SIZE)?;
    Ok(studio.picture(camera)?)
}

/// Films a mapping trial from start to end: the map, the scan, the estimated pose and the
/// trajectory. Returns the simulated seconds.
fn film(path: &Path) -> Result<f64, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    studio.set_frame_time(Duration::from_secs_f64(TICK));
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
    let spec = IndoorSpec { width: FILM_MAP, height: FILM_MAP, ..Default::default() };
    let (world, camera) = spawn(&mut studio, Environment::new(spec, FILM_SEED), FILM_SIZE)?;
    // Nothing needs to be drawn between pictures.
    if let Some(mut camera) = studio.app().world_mut().get_mut::<Camera>(camera) {
        camera.is_active = false;
    }
    let settings = TrialSettings { seed: Seed(FILM_SEED), ..Default::default() };
    studio.app().world_mut().entity_mut(world).insert(MappingTrial::new(settings));

    let mut film = Film::create(path, FRAMES_A_SECOND)?;
    loop {
        for _ in 0..TICKS_PER_FRAME {
            studio.step()?;
        }
        film.push(&studio.picture(camera)?)?;
        let trial = studio.app().world().get::<MappingTrial>(world);
        let trial = trial.filter(|trial| !trial.has_failed()).ok_or("the trial cannot begin")?;
        if trial.is_over() {
            let seconds = trial.trial().map_or(0.0, Trial::time);
            film.finish()?;
            return Ok(seconds);
        }
    }
}
