//! Draws every kind of world, without a window.
//!
//! `cargo run --release --features render --example gallery`
//!
//! Needs a graphics card with a Vulkan, Metal or DirectX driver, or Mesa's software Vulkan.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_envgen::capture::{Studio, find_renderer};
use bevy_envgen::envgen::{Kind, WorldSpec};
use bevy_envgen::prelude::*;
use clap::Parser;

/// Width and height of the pictures in pixels.
const SIZE: UVec2 = UVec2::new(800, 600);

/// Draws every kind of world and a mapping trial, without a window.
#[derive(Parser)]
struct Arguments {
    /// Folder to write into.
    #[arg(long, default_value = "docs/gallery")]
    out: PathBuf,
}

/// What is drawn: a name, a kind, its settings and a seed.
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
            #[expect(clippy::print_stderr, reason = "where errors are told")]
            {
                eprintln!("error: {error}");
            }
            std::process::ExitCode::FAILURE
        }
    }
}

#[expect(clippy::print_stdout, reason = "what an example is for")]
fn gallery(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    println!("drawing by {}", find_renderer()?);
    std::fs::create_dir_all(&arguments.out)?;
    for &(name, kind, settings, seed) in WORLDS {
        let mut spec = kind.parse::<Kind>()?.default_spec();
        for (setting, value) in settings {
            spec.set(setting, value)?;
        }
        let path = arguments.out.join(format!("{name}.png"));
        draw(spec, seed)?.write_png(&path)?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// A picture of a world as the plugin draws it.
fn draw(
    spec: WorldSpec,
    seed: u64,
) -> Result<bevy_envgen::capture::Picture, Box<dyn std::error::Error>> {
    let mut studio = Studio::new()?;
    studio.app().add_plugins(EnvgenPlugins::default()).insert_resource(ClearColor(Color::WHITE));
    let world = studio.app().world_mut().spawn(Environment::new(spec, seed)).id();
    studio.wait_until_ready(world)?;
    let camera = studio.camera_over(world, SIZE)?;
    Ok(studio.picture(camera)?)
}
