//! Three-dimensional meshes for the people and doors of scenarios.

use bevy::prelude::*;
use envgen::world::WallKind;

use super::draft::Draft;
use super::finish::Finish;
use super::finish_material::{can_draw, material};
use super::palette::Palette3d;
use crate::environment::GroundTruth;
use crate::part::PartOf;
use crate::scenario::{Door, DoorLeaf, Person};

/// The thickness in metres with which a leaf is drawn. In the scenario it has none.
const THICKNESS: f32 = 0.05;

/// The gap in metres below and above a leaf.
const CLEARANCE: f32 = 0.005;

/// A marker component of the mesh of a leaf, on a child of the leaf.
#[derive(Component)]
pub(super) struct LeafMesh;

/// A resource with the mesh of leaves, which has a length and height of 1 and is shared by all leaves of the
/// same colour.
#[derive(Resource, Default)]
pub(super) struct SharedLeafMesh(Option<(Color, Handle<Mesh>)>);

/// A resource with the mesh of figures, which is shared by all figures with the same colours of body and
/// head.
#[derive(Resource, Default)]
pub(super) struct FigureMesh(Option<([Color; 2], Handle<Mesh>)>);

/// A component that draws its entity as a person of 1.75 m, who looks along the x axis of the entity. People
/// of scenarios have it. An app can add it to other entities, such as players.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
#[require(Transform, Visibility)]
pub struct Figure;

/// A marker component of the mesh of a figure, on a child of the figure. Clones and scenes keep it, so that
/// the meshes that they contain can be found.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Debug, Default, Clone)]
pub(super) struct FigureBody;

/// A component with the child that draws a figure.
#[derive(Component)]
#[component(clone_behavior = Ignore)]
pub(super) struct DrawnFigure(Entity);

/// Adds a figure to a person.
pub(super) fn draw_person(added: On<Add, Person>, mut commands: Commands) {
    commands.entity(added.entity).try_insert(Figure);
}

/// Adds the mesh of a figure.
pub(super) fn draw_figure(added: On<Add, Figure>, mut commands: Commands) {
    let entity = added.entity;
    commands.queue(move |world: &mut World| {
        if !can_draw(world) || world.get_entity(entity).is_err() {
            return;
        }
        let Some(material) = material(world, Finish::Plain) else { return };
        let palette = world.resource::<Palette3d>();
        let colors = [palette.person, palette.head];
        let mesh = match &world.resource::<FigureMesh>().0 {
            Some((known, mesh)) if *known == colors => mesh.clone(),
            _ => {
                let figure = figure(palette);
                let mesh = world.resource_mut::<Assets<Mesh>>().add(figure);
                world.resource_mut::<FigureMesh>().0 = Some((colors, mesh.clone()));
                mesh
            }
        };
        if let Some(&DrawnFigure(last)) = world.get(entity) {
            world.commands().entity(last).try_despawn();
        }
        let name = Name::new("figure");
        let drawing = (name, FigureBody, Mesh3d(mesh), MeshMaterial3d(material), ChildOf(entity));
        let body = world.spawn(drawing).id();
        if let Ok(mut figure) = world.get_entity_mut(entity) {
            figure.insert(DrawnFigure(body));
        }
    });
}

/// Despawns the mesh of a figure that is removed.
pub(super) fn remove_figure(
    removed: On<Remove, Figure>,
    figures: Query<&DrawnFigure>,
    mut commands: Commands,
) {
    if let Ok(&DrawnFigure(body)) = figures.get(removed.entity) {
        commands.entity(body).try_despawn();
        commands.entity(removed.entity).try_remove::<DrawnFigure>();
    }
}

/// Despawns the meshes that were spawned from a scene, or cloned, together with their figure, since the
/// figure has a new mesh of its own.
pub(super) fn remove_clones(
    added: Query<(Entity, &ChildOf), Added<FigureBody>>,
    figures: Query<&DrawnFigure>,
    mut commands: Commands,
) {
    for (body, below) in &added {
        if let Ok(drawn) = figures.get(below.parent())
            && drawn.0 != body
        {
            commands.entity(body).try_despawn();
            // The list of children in a scene may have replaced the new child.
            commands.entity(drawn.0).try_insert(ChildOf(below.parent()));
        }
    }
}

/// Creates the mesh of a person of 1.75 m who looks along +x, with legs, body, head and hair.
fn figure(palette: &Palette3d) -> Mesh {
    let mut draft = Draft::default();
    let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let mut add = |mesh: Mesh, at: Vec3, color: Color| {
        draft.add_mesh(&mesh.transformed_by(Transform::from_translation(at)), color);
    };
    let capsule = |radius: f32, height: f32| {
        let mesh = Capsule3d::new(radius, height - 2.0 * radius).mesh().build();
        mesh.transformed_by(Transform::from_rotation(upright))
    };
    let ball = |radius: f32| Sphere::new(radius).mesh().uv(20, 14);
    let trousers: Color = (palette.person.to_linear() * 0.35).with_alpha(1.0).into();
    for side in [-0.09, 0.09] {
        add(capsule(0.085, 0.9), Vec3::new(0.0, side, 0.45), trousers);
    }
    let wide = Transform::from_scale(Vec3::new(0.85, 1.25, 1.0));
    add(capsule(0.17, 0.72).transformed_by(wide), Vec3::new(0.0, 0.0, 1.12), palette.person);
    for side in [-0.235, 0.235] {
        add(capsule(0.055, 0.62), Vec3::new(0.0, side, 1.08), palette.person);
    }
    add(ball(0.125), Vec3::new(0.0, 0.0, 1.62), palette.head);
    let hair: Color = (palette.head.to_linear() * 0.12).with_alpha(1.0).into();
    add(ball(0.128), Vec3::new(-0.022, 0.0, 1.642), hair);
    draft.into_mesh()
}

/// Adds the mesh of a leaf.
pub(super) fn draw_leaf(added: On<Add, DoorLeaf>, mut commands: Commands) {
    let leaf = added.entity;
    commands.queue(move |world: &mut World| {
        if !can_draw(world) {
            return;
        }
        let Some(length) = world.get::<DoorLeaf>(leaf).map(|leaf| leaf.length) else { return };
        let height = door_height(world, leaf);
        let Some(material) = material(world, Finish::Plain) else { return };
        let color = world.resource::<Palette3d>().door;
        let mesh = match &world.resource::<SharedLeafMesh>().0 {
            Some((known, mesh)) if *known == color => mesh.clone(),
            _ => {
                let mut draft = Draft::default();
                let half = 0.5 * THICKNESS;
                draft.add_box(Vec3::new(0.0, -half, 0.0), Vec3::new(1.0, half, 1.0), color);
                let mesh = world.resource_mut::<Assets<Mesh>>().add(draft.into_mesh());
                world.resource_mut::<SharedLeafMesh>().0 = Some((color, mesh.clone()));
                mesh
            }
        };
        let bottom = Transform::from_xyz(0.0, 0.0, CLEARANCE);
        let at = bottom.with_scale(Vec3::new(shown_length(length), 1.0, height - 2.0 * CLEARANCE));
        world.spawn((
            Name::new("leaf"),
            LeafMesh,
            Mesh3d(mesh),
            MeshMaterial3d(material),
            at,
            ChildOf(leaf),
        ));
    });
}

/// Returns the height in metres of the doorway of a leaf.
fn door_height(world: &World, leaf: Entity) -> f32 {
    let door = world.get::<ChildOf>(leaf).and_then(|above| world.get::<Door>(above.parent()));
    let truth = world.get::<PartOf>(leaf).and_then(|part| world.get::<GroundTruth>(part.0));
    let doorway =
        door.zip(truth).and_then(|(door, truth)| truth.doorways.get(door.doorway() as usize));
    let top = doorway.map_or(WallKind::Wall.extent().top(), |doorway| doorway.extent().top());
    top as f32
}

/// Returns the length of the mesh of a leaf. It is at least a millimetre, since a mesh without a length has
/// no direction. A millimetre is not visible.
fn shown_length(length: f32) -> f32 {
    length.max(1e-3)
}

/// Scales the meshes of sliding leaves to their length.
pub(super) fn stretch_leaves(
    leaves: Query<(&DoorLeaf, &Children), Changed<DoorLeaf>>,
    mut meshes: Query<&mut Transform, With<LeafMesh>>,
) {
    for (leaf, children) in &leaves {
        let mut meshes = meshes.iter_many_mut(children);
        while let Some(mut at) = meshes.fetch_next() {
            if at.scale.x != shown_length(leaf.length) {
                at.scale.x = shown_length(leaf.length);
            }
        }
    }
}
