//! Trees: every trunk and crown is a scaled copy of one of a few meshes, so that forests are drawn by
//! instancing.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use envgen::glam::{DVec2, DVec3};
use envgen::mesh::Mesh as Solid;
use envgen::world::{Crown, Extent, Tree};

use super::draft::Draft;
use super::finish::Finish;
use super::palette::Palette3d;
use super::tile::TileMesh;
use super::tree_levels::{LEVELS, TreeLevels};
use crate::environment::GroundTruth;
use crate::job::spawned_origin;
use crate::part::PartKind;
use crate::shape::PartShape;
use crate::spawn::TileSpawned;

/// For the trunks of thin, medium and thick trees: the number of sides, the radius for which the bark is
/// scaled, and the largest radius, in metres. Far from cameras the trunks have half and a quarter as many
/// sides.
const SIDES: [(u32, f64, f64); 3] = [(16, 0.05, 0.15), (28, 0.16, 0.5), (48, 0.47, f64::INFINITY)];

/// The number of corners around a crown, and of bands from its bottom to its top, from the nearest level to
/// the farthest.
const CROWN: [(u32, u32); LEVELS] = [(12, 6), (8, 4), (6, 3)];

/// Factors on the lightness of crowns, so that neighbouring crowns can be distinguished.
const SHADES: [f32; 3] = [0.9, 1.0, 1.12];

/// A resource with the meshes and materials that all trees share.
#[derive(Resource, Default)]
pub(super) struct TreeMeshes {
    crown: Option<Arc<[Handle<Mesh>; LEVELS]>>,
    trunks: BTreeMap<u32, Arc<[Handle<Mesh>; LEVELS]>>,
    bark: Option<Handle<StandardMaterial>>,
    /// The colours of trunks and crowns from which the materials were made.
    colors: Option<[Color; 2]>,
    leaves: Vec<Handle<StandardMaterial>>,
}

/// Spawns the trees of a tile.
pub(super) fn plant(world: &mut World, spawned: &TileSpawned) {
    let truth = world.get::<GroundTruth>(spawned.environment);
    let origin = spawned_origin(world, spawned.environment);
    let trees: Vec<(u32, Tree)> = spawned
        .placed(world)
        .filter(|(id, ..)| id.kind == PartKind::Tree)
        .filter_map(|(id, at, shape)| {
            if let Some(truth) = truth {
                return Some((id.index, *truth.trees.get(id.index as usize)?));
            }
            // A tree of an endless forest.
            let PartShape::Disc { radius } = shape else { return None };
            let center = at.translation.truncate().as_dvec2() + origin;
            Some((id.index, Tree::new(center, f64::from(*radius))))
        })
        .collect();
    if trees.is_empty() {
        return;
    }
    make_shared(world);
    let shared = world.resource::<TreeMeshes>();
    let (Some(crown), Some(bark)) = (shared.crown.clone(), shared.bark.clone()) else { return };
    let mut parts = Vec::with_capacity(2 * trees.len());
    for (index, tree) in trees {
        let sides = SIDES.iter().find(|(_, _, most)| tree.radius <= *most).unwrap_or(&SIDES[2]).0;
        let at = (tree.center - origin).as_vec2();
        let trunk = tree.trunk();
        let (Some(mesh), Some(leaves)) =
            (shared.trunks.get(&sides), shared.leaves.get(index as usize % SHADES.len()))
        else {
            continue;
        };
        let pose = Transform::from_translation(at.extend(trunk.bottom() as f32))
            .with_scale(Vec3::new(tree.radius as f32, tree.radius as f32, trunk.height() as f32));
        parts.push((
            TileMesh { finish: Finish::Bark },
            Mesh3d(mesh[0].clone()),
            TreeLevels(mesh.clone()),
            MeshMaterial3d(bark.clone()),
            pose,
            ChildOf(spawned.tile),
        ));
        let Crown { extent, radius } = tree.crown();
        let middle = (0.5 * (extent.bottom() + extent.top())) as f32;
        // Each crown is rotated differently. The trunk is round, so its rotation does not matter.
        let turn = Quat::from_rotation_z(0.7 * (index % 9) as f32);
        let pose = Transform::from_translation(at.extend(middle))
            .with_rotation(turn)
            .with_scale(Vec3::new(radius as f32, radius as f32, extent.height() as f32));
        parts.push((
            TileMesh { finish: Finish::Leaves },
            Mesh3d(crown[0].clone()),
            TreeLevels(crown.clone()),
            MeshMaterial3d(leaves.clone()),
            pose,
            ChildOf(spawned.tile),
        ));
    }
    world.spawn_batch(parts);
}

/// Creates the meshes and materials that trees share.
fn make_shared(world: &mut World) {
    let palette = world.resource::<Palette3d>().clone();
    let colors = Some([palette.trunk, palette.crown]);
    if world.resource::<TreeMeshes>().colors == colors {
        return;
    }
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    // All levels have the same volume, and so the same width on average.
    let mut drawn = |solids: [Solid; LEVELS], radius: f64, finish| {
        let volume = solids[0].volume();
        Arc::new(solids.map(|mut solid| {
            let widen = (volume / solid.volume()).sqrt();
            for position in &mut solid.positions {
                *position *= DVec3::new(widen, widen, 1.0);
            }
            for uv in &mut solid.uvs {
                // Trees are about four times as high as their unit.
                *uv *= DVec2::new(radius, 4.0);
            }
            let mut draft = Draft::of(finish);
            draft.add(&solid, DVec2::ZERO, Color::WHITE);
            meshes.add(draft.into_mesh())
        }))
    };
    let unit = |bottom, top| Extent::new(bottom, top).ok();
    let crown = unit(-0.5, 0.5).map(|extent| {
        let crown = Crown { extent, radius: 1.0 };
        let solid = |(around, bands)| Solid::coarse_ellipsoid(DVec2::ZERO, crown, around, bands);
        drawn(CROWN.map(solid), 1.0, Finish::Leaves)
    });
    let trunks = SIDES.iter().filter_map(|&(sides, radius, _)| {
        let extent = unit(0.0, 1.0)?;
        let solid = |part| Solid::cylinder(DVec2::ZERO, 1.0, extent, sides / part);
        Some((sides, drawn([1, 2, 4].map(solid), radius, Finish::Bark)))
    });
    let trunks = trunks.collect();
    let [bark, leaves] = [Finish::Bark, Finish::Leaves].map(|finish| finish.textured(world));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let bark = materials.add(StandardMaterial { base_color: palette.trunk, ..bark });
    let shaded = SHADES.iter().map(|&shade| {
        let color = (palette.crown.to_linear() * shade).with_alpha(1.0);
        materials.add(StandardMaterial { base_color: color.into(), ..leaves.clone() })
    });
    let leaves = shaded.collect();
    *world.resource_mut::<TreeMeshes>() =
        TreeMeshes { crown, trunks, bark: Some(bark), colors, leaves };
}
