//! Worlds in headless Bevy apps that are used as users use them.

mod bad_input;
#[cfg(feature = "debug")]
mod debug;
mod difficulty;
mod doors;
mod files;
#[cfg(feature = "debug")]
#[path = "../shared/gizmos.rs"]
mod gizmos;
#[cfg(feature = "debug")]
#[path = "../shared/inspector.rs"]
mod inspector;
mod other_plugins;
mod physics;
mod ready;
mod scenario;
mod streaming;
#[cfg(feature = "render")]
mod visuals;
#[cfg(feature = "render3d")]
mod visuals3d;
#[cfg(feature = "render3d")]
mod visuals3d_settings;
mod worlds;

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy_envgen::Tile;
use bevy_envgen::envgen::{WorldKind, WorldSpec};
use bevy_envgen::prelude::*;

/// Returns a spec of every kind, small enough to spawn instantly, with doors, rooms, surfaces and obstacles
/// if the kind has them.
fn specs() -> Vec<WorldSpec> {
    let settings: &[(&str, &[(&str, &str)])] = &[
        ("hallway", &[("segments", "60"), ("p_st", "0.3"), ("door_frame_rate", "0.1")]),
        ("hallway", &[("corners", "rounded"), ("pitch", "4"), ("alcove_rate", "0.1")]),
        ("forest", &[]),
        ("forest", &[("min_distance", "2.5"), ("intensity", "0.1"), ("radius", "0.4")]),
        ("road", &[]),
        ("cellular", &[]),
        ("indoor", &[]),
        ("indoor", &[("difficulty", "9"), ("profile", "thesis")]),
        (
            "landscape",
            &[
                ("speeds", "1,1,0.8,0.6,1,0.4,0.2,0,0"),
                ("algorithm", "smooth"),
                ("entropy", "1.9"),
                ("total_edge", "700"),
                ("order", "descending"),
            ],
        ),
    ];
    settings
        .iter()
        .map(|(kind, settings)| {
            let mut spec = kind.parse::<WorldKind>().unwrap().default_spec();
            for (name, value) in *settings {
                spec.set(name, value).unwrap();
            }
            spec
        })
        .collect()
}

/// Counts the entities that this crate has spawned: tiles, parts, leaves and meshes.
fn spawned(app: &mut App) -> usize {
    let tiles = app.world_mut().query::<&Tile>().iter(app.world()).count();
    let parts = app.world_mut().query::<&PartId>().iter(app.world()).count();
    let children = app.world_mut().query::<&ChildOf>().iter(app.world()).count();
    assert!(children >= tiles + parts);
    children
}

trait GenerateWorld {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World;
}

impl GenerateWorld for IndoorSpec {
    fn generate_world(self, seed: u64) -> bevy_envgen::envgen::World {
        use bevy_envgen::envgen::{Blueprint, Seed, Spec};
        self.generate(Seed(seed)).unwrap().to_world()
    }
}

/// Returns the folder of the project's assets.
fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").canonicalize().unwrap()
}
