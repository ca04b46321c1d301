//! Two-dimensional meshes for the people, leaves and smoke of scenarios.

use bevy::prelude::*;
use bevy::sprite_render::AlphaMode2d;
use envgen::scenario::PERSON_RADIUS;

use super::drawing::Drawing;
use super::palette::WorldPalette;
use super::part_group::{LAYER, PartGroup, material};
use crate::job::spawned_origin;
use crate::part::PartOf;
use crate::scenario::{DoorLeaf, Person, ScenarioRun, Smoke};
use crate::shape::{LocalFrame, PartShape};

/// The thickness in metres with which a leaf is drawn. In the scenario it has none.
const THICKNESS: f32 = 0.06;

/// The z coordinate of smoke, which is above everything else of a world.
const SMOKE_LAYER: f32 = 11.0 * LAYER;

/// The smallest extinction coefficient in 1/m of smoke that is drawn.
const THINNEST: f64 = 0.005;

/// A marker component of the mesh of a leaf, on a child of the leaf. The mesh has a length of 1.
#[derive(Component)]
pub(super) struct LeafMesh;

/// A marker component of the mesh of smoke, on a child of the smoke, which has a material of its own.
#[derive(Component)]
pub(super) struct SmokeMesh;

/// Returns the opacity of smoke: the fraction of light that it absorbs over a metre, limited so that what is
/// behind it remains visible.
pub(super) fn opacity(extinction: f64) -> f32 {
    (-libm::expm1(-extinction) as f32).min(0.85)
}

/// Adds the meshes of a person.
pub(super) fn draw_person(added: On<Add, Person>, mut commands: Commands) {
    let person = added.entity;
    commands.queue(move |world: &mut World| {
        let radius = PERSON_RADIUS as f32;
        let mut body = Drawing::default();
        body.add_shape(&Transform::IDENTITY, &PartShape::Disc { radius });
        add(world, person, PartGroup::Person, body);
        let mut face = Drawing::default();
        let corners = [Vec2::new(0.1, -0.12), Vec2::new(0.24, 0.0), Vec2::new(0.1, 0.12)];
        face.add(corners, &[[0, 1, 2]]);
        add(world, person, PartGroup::Face, face);
    });
}

/// Adds the mesh of a leaf.
pub(super) fn draw_leaf(added: On<Add, DoorLeaf>, mut commands: Commands) {
    let leaf = added.entity;
    commands.queue(move |world: &mut World| {
        let Some(length) = world.get::<DoorLeaf>(leaf).map(|leaf| leaf.length) else { return };
        let mut drawing = Drawing::default();
        let at = Transform::from_xyz(0.5, 0.0, 0.0);
        let half_size = Vec2::new(0.5, 0.5 * THICKNESS);
        drawing.add_shape(&at, &PartShape::Box { half_size });
        if let Some(mesh) = add(world, leaf, PartGroup::Leaf, drawing) {
            world.entity_mut(mesh).insert(LeafMesh);
            if let Some(mut at) = world.get_mut::<Transform>(mesh) {
                at.scale.x = length;
            }
        }
    });
}

/// Adds the meshes of the smoke of a scenario.
pub(super) fn draw_smoke(
    added: On<Insert, ScenarioRun>,
    runs: Query<&ScenarioRun>,
    mut commands: Commands,
) {
    let Ok(run) = runs.get(added.entity) else { return };
    draw_each_smoke(run, &mut commands, add_smoke);
}

/// Calls `add` for each place of smoke of a scenario.
pub(crate) fn draw_each_smoke(
    run: &ScenarioRun,
    commands: &mut Commands,
    add: fn(&mut World, Entity, &SmokeOutline),
) {
    for &smoke in run.smoke() {
        commands.queue(move |world: &mut World| {
            if let Some(place) = smoke_place(world, smoke) {
                add(world, smoke, &place);
            }
        });
    }
}

/// The places that smoke fills, and its extinction coefficient.
pub(crate) struct SmokeOutline {
    pub(crate) extinction: f64,
    /// The shapes in the frame of the world.
    pub(crate) shapes: Vec<envgen::geometry::Shape>,
    pub(crate) frame: LocalFrame,
}

fn smoke_place(world: &World, smoke: Entity) -> Option<SmokeOutline> {
    let smoke = world.get_entity(smoke).ok()?;
    let (&Smoke { index, extinction }, part) = (smoke.get::<Smoke>()?, smoke.get::<PartOf>()?);
    let run = world.get::<ScenarioRun>(part.0)?;
    let frame = LocalFrame::new(spawned_origin(world, part.0));
    let (place, _) = run.state().smoke().nth(index as usize)?;
    let shapes = run.state().smoke_shapes(place);
    Some(SmokeOutline { extinction, shapes, frame })
}

/// Adds the mesh of a place of smoke.
fn add_smoke(world: &mut World, entity: Entity, place: &SmokeOutline) {
    let SmokeOutline { extinction, shapes, frame } = place;
    let mut drawing = Drawing::default();
    for shape in shapes {
        let (at, shape) = frame.place(shape);
        drawing.add_shape(&at, &shape);
    }
    if drawing.triangles.is_empty() {
        return;
    }
    let palette = world.get_resource::<WorldPalette>().cloned().unwrap_or_default();
    let color = palette.smoke.with_alpha(opacity(*extinction));
    let Some(mut materials) = world.get_resource_mut::<Assets<ColorMaterial>>() else { return };
    let material = ColorMaterial { alpha_mode: AlphaMode2d::Blend, ..ColorMaterial::from(color) };
    let material = materials.add(material);
    let Some(mut meshes) = world.get_resource_mut::<Assets<Mesh>>() else { return };
    let mesh = meshes.add(drawing.into_mesh());
    world.spawn((
        Name::new("Smoke"),
        SmokeMesh,
        Mesh2d(mesh),
        MeshMaterial2d(material),
        Transform::from_xyz(0.0, 0.0, SMOKE_LAYER),
        shown(*extinction),
        ChildOf(entity),
    ));
}

/// Returns whether smoke is dense enough to be visible.
pub(crate) fn shown(extinction: f64) -> Visibility {
    if extinction < THINNEST { Visibility::Hidden } else { Visibility::Inherited }
}

/// Spawns a mesh as a child. Returns `None` in apps that do not draw.
fn add(world: &mut World, parent: Entity, group: PartGroup, drawing: Drawing) -> Option<Entity> {
    world.get_entity(parent).ok()?;
    let palette = world.get_resource::<WorldPalette>().cloned().unwrap_or_default();
    if !world.contains_resource::<Assets<ColorMaterial>>() {
        return None;
    }
    let mesh = world.get_resource_mut::<Assets<Mesh>>()?.add(drawing.into_mesh());
    let material = material(world, group, group.color(&palette))?;
    let at = Transform::from_xyz(0.0, 0.0, group.layer());
    let look = (Mesh2d(mesh), MeshMaterial2d(material));
    Some(world.spawn((Name::new(format!("{group:?}")), look, at, ChildOf(parent))).id())
}

/// Scales the meshes of sliding leaves to their length.
pub(super) fn stretch_leaves(
    leaves: Query<(&DoorLeaf, &Children), Changed<DoorLeaf>>,
    mut meshes: Query<&mut Transform, With<LeafMesh>>,
) {
    for (leaf, children) in &leaves {
        let mut meshes = meshes.iter_many_mut(children);
        while let Some(mut at) = meshes.fetch_next() {
            let scale = at.scale.with_x(leaf.length);
            if at.scale != scale {
                at.scale = scale;
            }
        }
    }
}

/// Sets the opacity of smoke from its extinction coefficient.
pub(super) fn fade_smoke(
    smoke: Query<(&Smoke, &Children), Changed<Smoke>>,
    mut meshes: Query<(&MeshMaterial2d<ColorMaterial>, &mut Visibility), With<SmokeMesh>>,
    materials: Option<ResMut<Assets<ColorMaterial>>>,
) {
    let Some(mut materials) = materials else { return };
    for (smoke, children) in &smoke {
        let mut meshes = meshes.iter_many_mut(children);
        while let Some((material, mut visibility)) = meshes.fetch_next() {
            visibility.set_if_neq(shown(smoke.extinction));
            if let Some(mut material) = materials.get_mut(&material.0) {
                material.color.set_alpha(opacity(smoke.extinction));
            }
        }
    }
}
