//! Smoke: boxes that hide what is in and behind them. The denser the smoke is, the more they hide.

use bevy::asset::{AssetServer, uuid_handle};
use bevy::core_pipeline::prepass::DepthPrepass;
use bevy::ecs::component::ComponentId;
use bevy::mesh::{MeshTag, MeshVertexBufferLayoutRef};
use bevy::pbr::{Material, MaterialPipeline, MaterialPipelineKey, MaterialPlugin, PbrPlugin};
use bevy::prelude::*;
use bevy::render::render_resource::{
    AsBindGroup, CompareFunction, Face, RenderPipelineDescriptor, SpecializedMeshPipelineError,
};
use bevy::shader::{Shader, ShaderRef};
use envgen::World as EnvgenWorld;
use envgen::geometry::Shape;
use envgen::glam::DVec2;
use envgen::mesh::convex_pieces;
use envgen::outline::outline;

use super::finish_material::can_draw;
use super::palette::Palette3d;
use super::settings::Visuals3dSettings;
use crate::environment::GroundTruth;
use crate::part::PartOf;
use crate::scenario::{ScenarioRun, Smoke};
use crate::shape::PartShape;
use crate::visuals::moving::{SmokeOutline, draw_each_smoke, shown};

const SHADER: Handle<Shader> = uuid_handle!("5c9a4a3e-5f0e-4a0c-9a57-1f7f3c9d8b21");

/// The brightness of smoke in light, as a fraction of its colour.
const LIT: f32 = 0.75;

/// The material of all boxes of smoke of a colour. The density and the brightness of a box are in its
/// [`MeshTag`], so that boxes are drawn in one draw call if nothing else that is transparent is between them
/// in the order of distance from the camera.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
pub(super) struct SmokeMaterial {
    #[uniform(0)]
    color: LinearRgba,
}

/// A tag has 20 bits for the square root of the extinction coefficient (1/m), in steps of 1/8192, and 12 bits
/// for the light.
const ROOT_STEPS: f64 = 8192.0;
const MOST_ROOT: f64 = 1_048_575.0;
const LIGHT_BITS: u32 = 12;
const MOST_LIGHT: f32 = 4095.0;

/// Returns the tag of a box of smoke in light from 0 to 1.
fn tag(extinction: f64, light: f32) -> MeshTag {
    let root = (extinction.max(0.0).sqrt() * ROOT_STEPS).min(MOST_ROOT).round() as u32;
    MeshTag((root << LIGHT_BITS) | (light.clamp(0.0, 1.0) * MOST_LIGHT).round() as u32)
}

/// A resource with the mesh that all boxes share, and the materials by colour.
#[derive(Resource)]
pub(super) struct SharedSmoke {
    mesh: Handle<Mesh>,
    materials: Vec<(LinearRgba, Handle<SmokeMaterial>)>,
}

impl Material for SmokeMaterial {
    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }

    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }

    fn specialize(
        _: &MaterialPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        _: &MeshVertexBufferLayoutRef,
        _: MaterialPipelineKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.primitive.cull_mode = Some(Face::Front);
        // The far sides of boxes are often inside walls. The shader itself ends rays at what is in front of
        // them.
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_compare = Some(CompareFunction::Always);
            depth.depth_write_enabled = Some(false);
        }
        Ok(())
    }
}

/// A component of a box of smoke, on a child of [`Smoke`].
#[derive(Component)]
pub(super) struct SmokeBox {
    /// The light on the box, as a fraction of the brightest light.
    light: f32,
}

pub(super) fn build(app: &mut App) {
    if !app.world().contains_resource::<AssetServer>() {
        return;
    }
    if !app.is_plugin_added::<PbrPlugin>() {
        app.init_asset::<SmokeMaterial>();
        return;
    }
    app.add_plugins(MaterialPlugin::<SmokeMaterial>::default());
    if let Some(mut shaders) = app.world_mut().get_resource_mut::<Assets<Shader>>() {
        let shader = Shader::from_wgsl(include_str!("smoke.wgsl"), file!());
        // The handle is not in use yet.
        shaders.insert(&SHADER, shader).ok();
    }
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

/// Adds the boxes of a place of smoke.
fn add_smoke(world: &mut World, entity: Entity, place: &SmokeOutline) {
    if !can_draw(world) || !world.contains_resource::<Assets<SmokeMaterial>>() {
        return;
    }
    let SmokeOutline { extinction, shapes, frame } = place;
    let environment = world.get::<PartOf>(entity).map(|part| part.0);
    let Some(truth) = environment.and_then(|entity| world.get::<GroundTruth>(entity)) else {
        return;
    };
    let settings = world.resource::<Visuals3dSettings>();
    let boxes: Vec<_> = shapes
        .iter()
        .flat_map(|shape| {
            let (height, light) = surroundings(truth, shape, settings);
            boxes(shape).into_iter().map(move |shape| (shape, height, light))
        })
        .filter_map(|(shape, height, light)| {
            let (at, PartShape::Box { half_size }) = frame.place(&shape) else { return None };
            let size = (2.0 * half_size).extend(height);
            let at = at.with_scale(size);
            let middle = at.translation.with_z(0.5 * height);
            Some((at.with_translation(middle), light))
        })
        .collect();
    let (mesh, material) = shared(world);
    for (at, light) in boxes {
        world.spawn((
            Name::new("smoke"),
            SmokeBox { light },
            Mesh3d(mesh.clone()),
            MeshMaterial3d(material.clone()),
            tag(*extinction, light),
            at,
            shown(*extinction),
            ChildOf(entity),
        ));
    }
}

/// Returns the mesh of all boxes, and the material of boxes in the current colour of smoke.
fn shared(world: &mut World) -> (Handle<Mesh>, Handle<SmokeMaterial>) {
    let brightness = world.resource::<Visuals3dSettings>().brightness;
    let color = world.resource::<Palette3d>().smoke.to_linear() * brightness;
    if !world.contains_resource::<SharedSmoke>() {
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(1.0));
        world.insert_resource(SharedSmoke { mesh, materials: Vec::new() });
    }
    let known = world.resource::<SharedSmoke>();
    let mesh = known.mesh.clone();
    if let Some((_, material)) = known.materials.iter().find(|(known, _)| *known == color) {
        return (mesh, material.clone());
    }
    let material = world.resource_mut::<Assets<SmokeMaterial>>().add(SmokeMaterial { color });
    world.resource_mut::<SharedSmoke>().materials.push((color, material.clone()));
    (mesh, material)
}

/// Returns boxes in place of a shape: a box itself, or the bounding boxes of the convex pieces of a polygon.
fn boxes(shape: &Shape) -> Vec<Shape> {
    let around = || vec![Shape::from_rect(shape.bounds())];
    match shape {
        Shape::Box { .. } => vec![shape.clone()],
        Shape::Polygon { .. } => {
            let (pivot, corners) = outline(shape);
            let Some(pieces) = convex_pieces(&corners) else { return around() };
            let bounds = |piece: Vec<u32>| {
                let corners = piece.iter().map(|&i| corners[i as usize] + pivot);
                envgen::geometry::Rect::around(corners).map(Shape::from_rect)
            };
            pieces.into_iter().filter_map(bounds).collect()
        }
        _ => around(),
    }
}

/// Returns the height of the room that the smoke is in, and the light there as a fraction of the brightest
/// light.
fn surroundings(truth: &EnvgenWorld, shape: &Shape, settings: &Visuals3dSettings) -> (f32, f32) {
    let middle: DVec2 = shape.bounds().center();
    let room = truth.rooms.iter().find(|room| room.shape.contains(middle));
    let top = room.map_or_else(|| truth.wall_top(), |room| room.extent().top());
    let is_lit = room.is_none_or(|room| room.lit);
    let light = if is_lit { LIT } else { settings.darkness.clamp(0.0, 1.0) };
    (top as f32, light)
}

/// Updates boxes to the extinction coefficient of their smoke.
pub(super) fn thicken_smoke(
    smoke: Query<(&Smoke, &Children), Changed<Smoke>>,
    mut boxes: Query<(&SmokeBox, &mut MeshTag, &mut Visibility)>,
) {
    for (smoke, children) in &smoke {
        let mut boxes = boxes.iter_many_mut(children);
        while let Some((smoke_box, mut known, mut visibility)) = boxes.fetch_next() {
            visibility.set_if_neq(shown(smoke.extinction));
            known.set_if_neq(tag(smoke.extinction, smoke_box.light));
        }
    }
}

/// A marker component of a camera whose depth prepass was added because of smoke.
#[derive(Component)]
pub(super) struct GivenDepths;

/// Adds a depth prepass to cameras while there is smoke, which ends at the depths of solid surfaces.
pub(super) fn measure_depths(
    smoke: Query<(), With<SmokeBox>>,
    cameras: Query<Entity, (With<Camera3d>, Without<DepthPrepass>)>,
    given: Query<Entity, With<GivenDepths>>,
    mut commands: Commands,
) {
    if smoke.is_empty() {
        for camera in &given {
            commands.entity(camera).queue_silenced(take_depths);
        }
        return;
    }
    for camera in &cameras {
        commands.entity(camera).try_insert((DepthPrepass, GivenDepths));
    }
}

/// Removes the depth prepass that was added to a camera, unless another component of the camera requires it by now,
/// such as ambient occlusion.
fn take_depths(mut camera: EntityWorldMut<'_>) {
    camera.remove::<GivenDepths>();
    let world = camera.world();
    let Some(depths) = world.component_id::<DepthPrepass>() else { return };
    let requires = |&id: &ComponentId| {
        let required = world.get_required_components_by_id(id);
        required.is_some_and(|required| required.iter_ids().any(|id| id == depths))
    };
    if !camera.archetype().components().iter().any(requires) {
        camera.remove::<DepthPrepass>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoke_of_a_colour_shares_its_mesh_and_material() {
        let mut world = World::new();
        world.init_resource::<Assets<Mesh>>();
        world.init_resource::<Assets<SmokeMaterial>>();
        world.init_resource::<Visuals3dSettings>();
        world.init_resource::<Palette3d>();
        let first = shared(&mut world);
        assert_eq!(shared(&mut world), first);
        world.resource_mut::<Palette3d>().smoke = Color::BLACK;
        let other = shared(&mut world);
        assert_eq!(other.0, first.0);
        assert_ne!(other.1, first.1);
        // The first material keeps its colour.
        let materials = world.resource::<Assets<SmokeMaterial>>();
        let color = Palette3d::default().smoke.to_linear();
        assert_eq!(materials.get(&first.1).expect("a material").color, color);
        assert_eq!((materials.len(), world.resource::<Assets<Mesh>>().len()), (2, 1));
    }

    #[test]
    fn tags_hold_extinction_and_light() {
        for (extinction, light) in [(0.0, 0.0), (0.02, 0.75), (1.3, 1.0), (40.0, 0.25)] {
            let MeshTag(tag) = tag(extinction, light);
            let root = f64::from(tag >> LIGHT_BITS) / ROOT_STEPS;
            assert!((root * root - extinction).abs() <= 1e-3 * extinction, "{extinction}");
            assert!(((tag & 0xfff) as f32 / MOST_LIGHT - light).abs() < 2e-4, "{light}");
        }
        // Values that are out of range are clamped.
        assert_eq!(tag(f64::INFINITY, f32::INFINITY), MeshTag(u32::MAX));
        assert_eq!(tag(-1.0, -1.0), MeshTag(0));
        assert_eq!(tag(f64::NAN, f32::NAN), MeshTag(0));
    }
}
