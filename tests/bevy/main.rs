//! Worlds in headless Bevy apps, driven as a user drives them.

mod bad_input;
#[cfg(feature = "render")]
mod debug;
mod doors;
mod files;
mod other_plugins;
mod physics;
mod ready;
mod robot;
mod streaming;
mod trial;
#[cfg(feature = "render")]
mod view;
#[cfg(feature = "render")]
mod visuals;
mod worlds;

use bevy::prelude::*;
use bevy_envgen::Tile;
use bevy_envgen::bevy_rapier2d::prelude::{RapierContextColliders, RapierRigidBodySet};
use bevy_envgen::envgen::{WorldKind, WorldSpec};
use bevy_envgen::prelude::*;

/// A spec of every kind, of a size that is spawned in an instant, with doors, rooms, surfaces and
/// obstacles where the kind has them.
fn specs() -> Vec<WorldSpec> {
    let settings: &[(&str, &[(&str, &str)])] = &[
        ("hallway", &[("segments", "60"), ("p_st", "0.3"), ("door_frame_rate", "0.1")]),
        ("hallway", &[("corners", "rounded"), ("pitch", "4"), ("alcove_rate", "0.1")]),
        ("forest", &[]),
        ("forest", &[("min_distance", "2.5"), ("intensity", "0.1"), ("radius", "0.4")]),
        ("road", &[]),
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

/// Entities that this crate made: tiles, parts, leaves, meshes.
fn spawned(app: &mut App) -> usize {
    let tiles = app.world_mut().query::<&Tile>().iter(app.world()).count();
    let parts = app.world_mut().query::<&PartId>().iter(app.world()).count();
    let children = app.world_mut().query::<&ChildOf>().iter(app.world()).count();
    assert!(children >= tiles + parts);
    children
}

/// Colliders and bodies in rapier's own sets.
fn in_rapier(app: &mut App) -> (usize, usize) {
    let mut sets = app.world_mut().query::<(&RapierContextColliders, &RapierRigidBodySet)>();
    let (colliders, bodies) = sets.single(app.world()).unwrap();
    assert_eq!(colliders.colliders.len(), colliders.entity2collider().len());
    (colliders.colliders.len(), bodies.bodies.len())
}
