//! What surrounds the tiles of a world: ground, ambient light and the sun. Also the ceilings over its rooms.

use std::collections::BTreeMap;

use bevy::light::{CascadeShadowConfigBuilder, IrradianceVolume};
use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::geometry::Rect as WorldRect;
use envgen::glam::DVec2;
use envgen::mesh::Mesh as Solid;
use envgen::pieces::{Form, ceiling_of};
use envgen::world::{Extent, PartId, PartKind};

use super::draft::Draft;
use super::finish::Finish;
use super::finish_material::material;
use super::glow::{self, is_building};
use super::palette::Palette3d;
use super::settings::Visuals3dSettings;
use crate::environment::{EndlessTruth, Environment, GroundTruth, SpawnedOrigin};
use crate::job::spawned_origin;
use crate::streaming::StreamAround;

/// A marker component of the ground and the light of a world, on a child of its [`Environment`]. The children
/// of this entity are drawn. A stage that was spawned from a scene, or cloned, is replaced.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
#[require(Transform, Visibility)]
pub struct Stage;

/// A marker component of the sun over a world, on an entity with a `DirectionalLight`.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub struct Sun;

/// The depth in metres of the ground around a world below the floors of the world.
const BELOW: f64 = 0.04;

/// The same for worlds without floors, whose trees and robots are on this ground.
const BESIDE: f64 = 0.002;

/// How far the ground extends beyond the bounds of the world, in metres and as a fraction of their size.
const BEYOND: (f64, f64) = (80.0, 1.0);

/// Half the side of the ground of endless worlds in metres.
const ENDLESS: f64 = 3000.0;

/// The step in metres by which the ground of endless worlds moves, which is a multiple of the side of its
/// texture.
const STEP: f32 = 1200.0;

/// The illuminance of the sun in lux in the open, and the fraction of it over buildings without ceilings, for
/// the default exposure of Bevy's cameras.
const SUN: (f32, f32) = (2200.0, 0.35);

/// The direction to the sun.
const TO_SUN: Vec3 = Vec3::new(-0.45, -0.6, 1.0);

/// The bottom and the top of thresholds in metres. They are slightly lower than the floors beside them, which
/// they may overlap. If they were much lower, the sides of those floors would be visible as dotted lines.
const THRESHOLD: (f64, f64) = (-0.1, -0.0003);

/// An environment with its world, finite or endless.
type Grown<'a> = (Entity, Option<&'a GroundTruth>, Option<&'a EndlessTruth>);

/// A filter for environments with another world, or another origin of it.
type Renewed = Or<(Changed<GroundTruth>, Changed<EndlessTruth>, Changed<SpawnedOrigin>)>;

/// The stages of worlds, by their environments.
type Stages<'w, 's> = Query<'w, 's, (Entity, &'static ChildOf), With<Stage>>;

/// Spawns the stages of worlds that are new or changed, and of all worlds when the settings change.
pub(super) fn set_stage(
    settings: Res<Visuals3dSettings>,
    mut built_with: Local<Option<([bool; 2], [u32; 3])>>,
    environments: Query<Grown<'_>, With<Environment>>,
    renewed: Query<(), Renewed>,
    stages: Stages<'_, '_>,
    mut commands: Commands,
) {
    // Settings are compared, since a panel that shows them may mark them as changed in every frame; by their
    // bits, since a NaN does not equal itself.
    let Visuals3dSettings {
        ceilings,
        shadows,
        lamp_spacing,
        brightness,
        darkness,
        sky: _,
        detail_distance: _,
    } = *settings;
    let numbers = [lamp_spacing, brightness, darkness].map(f32::to_bits);
    let wanted = ([ceilings, shadows], numbers);
    let all = built_with.replace(wanted) != Some(wanted);
    let stages: BTreeMap<Entity, Entity> =
        stages.iter().map(|(stage, parent)| (parent.parent(), stage)).collect();
    for (&environment, &stage) in &stages {
        let has_world = |(_, truth, endless): Grown<'_>| truth.is_some() || endless.is_some();
        if !environments.get(environment).is_ok_and(has_world) {
            commands.entity(stage).try_despawn();
        }
    }
    for (entity, truth, endless) in &environments {
        let last = stages.get(&entity).copied();
        let is_due = all || last.is_none() || renewed.contains(entity);
        if !is_due || (truth.is_none() && endless.is_none()) {
            continue;
        }
        if let Some(last) = last {
            commands.entity(last).try_despawn();
        }
        let truth = truth.map(|truth| truth.0.clone());
        commands.queue(move |world: &mut World| {
            // An observer of another stage may have despawned the environment.
            if world.get_entity(entity).is_ok() {
                let origin = spawned_origin(world, entity);
                let stage = world.spawn((Name::new("stage"), Stage, ChildOf(entity))).id();
                // So may one of this stage.
                if world.get_entity(stage).is_ok() {
                    spawn_stage(world, stage, origin, truth.as_deref());
                }
            }
        });
    }
}

/// Moves the ground and the light of endless worlds along with their anchors, in steps of whole textures.
pub(super) fn follow_anchors(
    mut stages: Query<(&ChildOf, &mut Transform), With<Stage>>,
    endless: Query<(&StreamAround, &GlobalTransform), With<EndlessTruth>>,
    anchors: Query<&GlobalTransform>,
) {
    for (parent, mut stage) in &mut stages {
        let Ok((stream, frame)) = endless.get(parent.parent()) else { continue };
        let Ok(anchor) = anchors.get(stream.anchor) else { continue };
        let at = frame.affine().inverse().transform_point3(anchor.translation());
        let off = (at - stage.translation).truncate();
        if off.is_finite() && off.abs().max_element() > 0.5 * ENDLESS as f32 {
            let steps = (at.truncate() / STEP).round();
            stage.translation = (STEP * steps).extend(stage.translation.z);
        }
    }
}

/// Shows only one sun, since each would light the whole app: the brightest sun of the worlds that are
/// visible.
pub(super) fn share_sun(
    mut suns: Query<(Entity, &ChildOf, &DirectionalLight, &mut Visibility), With<Sun>>,
    stages: Query<&InheritedVisibility>,
) {
    let is_seen = |stage: &ChildOf| stages.get(stage.parent()).is_ok_and(|seen| seen.get());
    let shining = suns
        .iter()
        .max_by(|(a, of_a, light_a, _), (b, of_b, light_b, _)| {
            let brighter = light_a.illuminance.total_cmp(&light_b.illuminance);
            is_seen(of_a).cmp(&is_seen(of_b)).then(brighter).then(b.cmp(a))
        })
        .map(|(sun, ..)| sun);
    for (sun, .., mut visibility) in &mut suns {
        let is_shown = shining == Some(sun);
        visibility.set_if_neq(if is_shown { Visibility::Inherited } else { Visibility::Hidden });
    }
}

fn spawn_stage(world: &mut World, stage: Entity, origin: DVec2, truth: Option<&EnvgenWorld>) {
    let settings = *world.resource::<Visuals3dSettings>();
    let palette = world.resource::<Palette3d>().clone();
    let building = truth.filter(|truth| is_building(truth));
    // Ground.
    let bounds = truth.map_or_else(
        || WorldRect::new(origin - DVec2::splat(ENDLESS), origin + DVec2::splat(ENDLESS)),
        |truth| truth.bounds.grown(BEYOND.0 + BEYOND.1 * truth.bounds.size().max_element()),
    );
    let is_green = truth.is_none_or(|truth| {
        !truth.trees.is_empty() || !truth.road_strips.is_empty() || truth.raster.is_some()
    });
    let color = if is_green { palette.meadow } else { palette.ground };
    let mut draft = Draft::default();
    let corners = envgen::geometry::Shape::from_rect(bounds).corners();
    let corners: Vec<Vec2> = corners.iter().map(|p| (*p - origin).as_vec2()).collect();
    let has_floors = truth.is_some_and(|truth| is_building(truth) || truth.raster.is_some());
    // Without floors, the floors of another world beside this one may lie over this ground.
    let top = if has_floors { -BELOW } else { -BESIDE };
    draft.add_flat(&corners, top as f32, color);
    // The ambient light of buildings ends at their walls.
    let finish = if building.is_some() { Finish::Mark } else { Finish::Ground };
    if let Some(material) = material(world, finish) {
        let mesh = world.resource_mut::<Assets<Mesh>>().add(draft.into_mesh());
        let name = Name::new("ground");
        world.spawn((name, Mesh3d(mesh), MeshMaterial3d(material), ChildOf(stage)));
    }
    // Light.
    let (voxels, at) = match building {
        Some(truth) => glow::of_building(truth, origin, &settings),
        None => glow::of_sky(bounds, origin),
    };
    let voxels = world.resource_mut::<Assets<Image>>().add(voxels);
    let intensity = glow::INTENSITY * settings.brightness;
    let volume = IrradianceVolume { voxels, intensity, ..default() };
    world.spawn((Name::new("light"), volume, at, ChildOf(stage)));
    // The sun.
    let share = match building {
        Some(_) if settings.ceilings => return,
        Some(_) => SUN.1,
        None => 1.0,
    };
    let size = truth.map_or(100.0, |truth| truth.bounds.size().max_element());
    let shadows = CascadeShadowConfigBuilder {
        num_cascades: 2,
        first_cascade_far_bound: 15.0,
        maximum_distance: (2.0 * size).clamp(40.0, 250.0) as f32,
        ..default()
    };
    world.spawn((
        Name::new("sun"),
        Sun,
        DirectionalLight {
            illuminance: SUN.0 * share * settings.brightness,
            shadow_maps_enabled: settings.shadows,
            ..default()
        },
        shadows.build(),
        Transform::from_translation(TO_SUN).looking_at(Vec3::ZERO, Vec3::Z),
        ChildOf(stage),
    ));
}

/// Adds the floor of a doorway, since the floors of rooms end at the walls.
pub(super) fn add_threshold(
    drafts: &mut BTreeMap<Finish, Draft>,
    truth: &EnvgenWorld,
    part: PartId,
    origin: DVec2,
    palette: &Palette3d,
) {
    let Some(doorway) = truth.doorways.get(part.index as usize).filter(|_| is_building(truth))
    else {
        return;
    };
    let Ok(extent) = Extent::new(THRESHOLD.0, THRESHOLD.1) else { return };
    if let Some(solid) = Solid::extruded(&doorway.shape, extent) {
        let draft = drafts.entry(Finish::Floor).or_insert_with(|| Draft::of(Finish::Floor));
        draft.add(&solid, origin, palette.room);
    }
}

/// Adds the ceiling of a room or hallway, and lamps below it unless the room is dark.
pub(super) fn add_ceiling(
    drafts: &mut BTreeMap<Finish, Draft>,
    truth: &EnvgenWorld,
    part: PartId,
    origin: DVec2,
    wall_top: f64,
    palette: &Palette3d,
    settings: &Visuals3dSettings,
) {
    let Some(ceiling) = ceiling_of(truth, part, wall_top) else { return };
    if let Ok(solid) = Solid::of(&ceiling) {
        drafts.entry(Finish::Ceiling).or_default().add(&solid, origin, palette.ceiling);
    }
    let is_room = part.kind == PartKind::Room;
    let is_lit = !is_room || truth.rooms.get(part.index as usize).is_some_and(|room| room.lit);
    let (Form::Prism { shape, extent }, true) = (&ceiling.form, is_lit) else { return };
    let top = extent.bottom();
    let lamps = glow::lamps(shape, settings);
    let draft = drafts.entry(Finish::Lamp).or_default();
    for lamp in lamps {
        let middle = (lamp - origin).as_vec2().extend(top as f32);
        let half = Vec3::new(0.3, 0.15, 0.0);
        draft.add_box(
            middle - half - Vec3::Z * 0.05,
            middle + half - Vec3::Z * 0.001,
            palette.lamp,
        );
    }
}
