//! Two-dimensional meshes and colours for the parts of worlds, and for the people, doors and smoke of
//! scenarios.

mod drawing;
pub(crate) mod ground;
pub(crate) mod moving;
mod palette;
mod part_group;

use std::collections::BTreeMap;

use bevy::prelude::*;

use self::drawing::Drawing;
use self::ground::class_rectangles;
pub use self::palette::{WorldPalette, color};
use self::part_group::{GroupMaterials, PartGroup, material};
use crate::environment::{Environment, GroundTruth};
use crate::job::spawned_origin;
use crate::part::{Ground, PartId, PartKind, Room, Surface, SurfaceKind};
use crate::require::require_component;
use crate::scenario::{Door, DoorLeaf, Person, ScenarioSystems, Smoke};
use crate::shape::PartShape;
use crate::spawn::{ROAD_TOLERANCE, Tile, TileSpawned};
use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// The system set that updates the drawing in two dimensions.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct FlatDrawing;

/// Draws the parts of worlds with one mesh per tile and colour, as children of the tile. The people, leaves
/// and smoke of scenarios have meshes as children.
///
/// Needs Bevy's plugins for meshes and `ColorMaterial`s, and draws nothing without them. No other plugin
/// depends on this one. By default it uses the `WorldPalette` that the app already has, if any.
#[derive(Clone, Debug, Default)]
pub struct EnvgenVisualsPlugin {
    palette: Option<WorldPalette>,
}

impl EnvgenVisualsPlugin {
    /// Inserts `palette` as the colours, replacing those that the app already has.
    pub fn new(palette: WorldPalette) -> Self {
        EnvgenVisualsPlugin { palette: Some(palette) }
    }
}

impl Plugin for EnvgenVisualsPlugin {
    fn build(&self, app: &mut App) {
        match &self.palette {
            Some(palette) => app.insert_resource(palette.clone()),
            None => app.init_resource::<WorldPalette>(),
        };
        app.register_type::<WorldPalette>()
            .init_resource::<GroupMaterials>()
            .add_observer(draw)
            .add_observer(moving::draw_person)
            .add_observer(moving::draw_leaf)
            .add_observer(moving::draw_smoke);
        let main = EnvgenSchedules::of(app).main;
        app.add_systems(
            main,
            (moving::stretch_leaves, moving::fade_smoke)
                .in_set(FlatDrawing)
                .after(EnvgenSystems::Notify)
                // An app may have scenarios in the same schedule.
                .after(ScenarioSystems),
        );
        require_visibility(app);
    }
}

/// Makes [`Visibility`] a required component of environments, tiles, parts and entities of scenarios, so that
/// an app can hide them with everything below them. What is below an entity without it is visible. It is no
/// error if another plugin has already required it, or if some of these entities exist.
pub fn require_visibility(app: &mut App) {
    require_component::<Environment, Visibility>(app);
    require_component::<Tile, Visibility>(app);
    require_component::<PartId, Visibility>(app);
    require_component::<Person, Visibility>(app);
    require_component::<Door, Visibility>(app);
    require_component::<DoorLeaf, Visibility>(app);
    require_component::<Smoke, Visibility>(app);
}

/// Draws the parts of a tile.
fn draw(spawned: On<TileSpawned>, mut commands: Commands) {
    let spawned = spawned.event().clone();
    commands.queue(move |world: &mut World| add_meshes(world, &spawned));
}

fn add_meshes(world: &mut World, spawned: &TileSpawned) {
    let drawable = world.contains_resource::<Assets<Mesh>>()
        && world.contains_resource::<Assets<ColorMaterial>>();
    // Another observer of the tile may have despawned it.
    if !drawable || world.get_entity(spawned.tile).is_err() {
        return;
    }
    let palette = world.get_resource::<WorldPalette>().cloned().unwrap_or_default();
    for (group, drawing) in drawings(world, spawned) {
        let Some(material) = material(world, group, group.color(&palette)) else { return };
        let Some(mut meshes) = world.get_resource_mut::<Assets<Mesh>>() else { return };
        let mesh = meshes.add(drawing.into_mesh());
        world.spawn((
            Name::new(format!("{group:?}")),
            Mesh2d(mesh),
            MeshMaterial2d(material),
            Transform::from_xyz(0.0, 0.0, group.layer()),
            ChildOf(spawned.tile),
        ));
    }
}

/// Returns the triangles of the parts of a tile, by group.
fn drawings(world: &World, spawned: &TileSpawned) -> BTreeMap<PartGroup, Drawing> {
    let mut drawings: BTreeMap<PartGroup, Drawing> = BTreeMap::new();
    for &part in &spawned.parts {
        let Ok(part) = world.get_entity(part) else { continue };
        let (Some(id), Some(at), Some(shape)) =
            (part.get::<PartId>(), part.get::<Transform>(), part.get::<PartShape>())
        else {
            continue;
        };
        let group = match id.kind {
            PartKind::Ground => {
                if let Some(ground) = part.get::<Ground>() {
                    for (class, corners) in class_rectangles(at, shape, ground) {
                        let drawing = drawings.entry(PartGroup::Class(class)).or_default();
                        drawing.add(corners, &[[0, 1, 2], [0, 2, 3]]);
                    }
                }
                continue;
            }
            PartKind::RoadStrip => {
                let drawing = drawings.entry(PartGroup::Road).or_default();
                add_road(drawing, world, spawned.environment, *id);
                continue;
            }
            // These are drawn below, together with those that are data.
            PartKind::Wall | PartKind::Tree | PartKind::Obstacle => continue,
            PartKind::Room if part.get::<Room>().is_some_and(|room| !room.lit) => {
                PartGroup::DarkRoom
            }
            PartKind::Room => PartGroup::Room,
            PartKind::Doorway => PartGroup::Doorway,
            PartKind::Surface => match part.get::<Surface>().map(|surface| surface.kind) {
                Some(SurfaceKind::Water) => PartGroup::Water,
                Some(SurfaceKind::Hallway | SurfaceKind::OpenArea) => PartGroup::Floor,
                Some(SurfaceKind::Slippery) => PartGroup::Slippery,
                Some(SurfaceKind::Loose) => PartGroup::Loose,
                // The cells of the landscape draw it.
                Some(SurfaceKind::Class(_)) => continue,
                _ => PartGroup::Rough,
            },
            PartKind::Start => PartGroup::Start,
            PartKind::Goal => PartGroup::Goal,
            PartKind::Victim => PartGroup::Victim,
        };
        drawings.entry(group).or_default().add_shape(at, shape);
    }
    let truth = world.get::<GroundTruth>(spawned.environment);
    let is_dark = |id: &PartId| {
        let part = truth.zip(id.in_world());
        part.is_some_and(|(truth, part)| truth.visible_range(part).is_some())
    };
    for (id, at, shape) in spawned.placed(world) {
        let group = match id.kind {
            PartKind::Wall | PartKind::Obstacle if is_dark(&id) => PartGroup::Dark,
            PartKind::Wall => PartGroup::Wall,
            PartKind::Tree => PartGroup::Tree,
            PartKind::Obstacle => PartGroup::Obstacle,
            _ => continue,
        };
        drawings.entry(group).or_default().add_shape(at, shape);
    }
    drawings.retain(|_, drawing| !drawing.triangles.is_empty());
    drawings
}

/// Adds the exact surface of a road, which is computed from the world itself.
fn add_road(drawing: &mut Drawing, world: &World, environment: Entity, id: PartId) {
    let truth = world.get::<GroundTruth>(environment);
    let (Some(truth), origin) = (truth, spawned_origin(world, environment)) else { return };
    let Some(strip) = truth.road_strips.get(id.index as usize) else { return };
    let mesh = strip.mesh(ROAD_TOLERANCE);
    drawing.add(mesh.vertices.iter().map(|v| (*v - origin).as_vec2()), &mesh.triangles);
}
