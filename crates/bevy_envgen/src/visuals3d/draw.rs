//! Draws the parts of a tile.

use std::collections::BTreeMap;

use bevy::prelude::*;
use envgen::mesh::Mesh as Solid;
use envgen::pieces::pieces_of;

use super::draft::Draft;
use super::finish::Finish;
use super::finish_material::{can_draw, material};
use super::look::look;
use super::palette::Palette3d;
use super::settings::Visuals3dSettings;
use super::tile::{TileMesh, is_shown};
use super::{marks, stage, trees};
use crate::environment::GroundTruth;
use crate::job::spawned_origin;
use crate::overhead::{Overhead, find_overhead};
use crate::part::{Ground, PartKind};
use crate::shape::PartShape;
use crate::spawn::TileSpawned;
use crate::visuals::color;
use crate::visuals::ground::class_rectangles;

/// Draws the parts of a tile.
pub(super) fn draw(spawned: On<TileSpawned>, mut commands: Commands) {
    let spawned = spawned.event().clone();
    commands.queue(move |world: &mut World| add_meshes(world, &spawned));
}

fn add_meshes(world: &mut World, spawned: &TileSpawned) {
    // Another observer of the tile may have despawned it.
    if !can_draw(world) || world.get_entity(spawned.tile).is_err() {
        return;
    }
    let has_top = |kind| matches!(kind, PartKind::Doorway | PartKind::Room | PartKind::Surface);
    find_overhead(world, spawned.environment, &spawned.parts, has_top);
    for (finish, draft) in drafts(world, spawned) {
        let Some(material) = material(world, finish) else { return };
        let mesh = world.resource_mut::<Assets<Mesh>>().add(draft.into_mesh());
        let shown = is_shown(finish, world.resource::<Visuals3dSettings>());
        world.spawn((
            Name::new(format!("{finish:?}")),
            TileMesh { finish },
            Mesh3d(mesh),
            MeshMaterial3d(material),
            shown,
            ChildOf(spawned.tile),
        ));
    }
    trees::plant(world, spawned);
}

/// Returns the bodies of a tile by finish, without trees.
fn drafts(world: &World, spawned: &TileSpawned) -> BTreeMap<Finish, Draft> {
    let mut drafts: BTreeMap<Finish, Draft> = BTreeMap::new();
    let palette = world.resource::<Palette3d>();
    let settings = world.resource::<Visuals3dSettings>();
    let origin = spawned_origin(world, spawned.environment);
    let truth = world.get::<GroundTruth>(spawned.environment);
    let overhead = world.get::<Overhead>(spawned.environment);
    for (id, at, _) in spawned.placed(world) {
        match id.kind {
            // They are drawn below, and in `trees`.
            PartKind::Ground | PartKind::Tree => continue,
            PartKind::Start | PartKind::Goal | PartKind::Victim => {
                marks::add(&mut drafts, id.kind, at, palette);
                continue;
            }
            _ => {}
        }
        let Some((truth, part)) = truth.zip(id.in_world()) else { continue };
        let lintel = overhead.filter(|_| id.kind == PartKind::Doorway);
        let lintel = lintel.and_then(|known| *known.lintels.get(part.index as usize)?);
        for piece in pieces_of(truth, part, lintel) {
            let Some((finish, color)) = look(truth, &piece, palette) else { continue };
            match Solid::of(&piece) {
                Ok(solid) => drafts
                    .entry(finish)
                    .or_insert_with(|| Draft::of(finish))
                    .add(&solid, origin, color),
                Err(error) => log::warn!("{error}"),
            }
        }
        if id.kind == PartKind::Doorway {
            stage::add_threshold(&mut drafts, truth, part, origin, palette);
        }
        if let Some(Overhead { wall_top, .. }) = overhead {
            stage::add_ceiling(&mut drafts, truth, part, origin, *wall_top, palette, settings);
        }
        if let Some(strip) = truth.road_strips.get(part.index as usize)
            && id.kind == PartKind::RoadStrip
        {
            marks::add_lanes(drafts.entry(Finish::Mark).or_default(), strip, origin, palette);
        }
    }
    for &part in &spawned.parts {
        let Ok(part) = world.get_entity(part) else { continue };
        if let (Some(at), Some(shape), Some(ground)) =
            (part.get::<Transform>(), part.get::<PartShape>(), part.get::<Ground>())
        {
            let draft = drafts.entry(Finish::Ground).or_default();
            for (class, corners) in class_rectangles(at, shape, ground) {
                draft.add_flat(&corners, 0.0, color(envgen::palette::class(class)));
            }
        }
    }
    drafts.retain(|_, draft| !draft.is_empty());
    drafts
}
