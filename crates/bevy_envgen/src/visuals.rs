//! Meshes and colours for the parts of worlds, and for the people, doors and smoke of scenarios.

pub(crate) mod ground;
pub(crate) mod moving;

use std::collections::BTreeMap;
use std::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use envgen::palette::{self, Srgb};

use self::ground::class_rectangles;
use crate::environment::{Environment, GroundTruth};
use crate::part::{Ground, PartId, PartKind, Room, Surface, SurfaceKind};
use crate::scenario::{Door, DoorLeaf, Person, Smoke};
use crate::shape::PartShape;
use crate::spawn::{Tile, TileSpawned};
use crate::tessellate::triangles;
use crate::{EnvgenSystems, Schedules};

/// Distance in z between layers.
const LAYER: f32 = 0.01;

/// The largest distance of road meshes from the exact edges, in metres.
const ROAD_TOLERANCE: f64 = 0.01;

/// Side of the mark of a start, goal or victim in metres.
const MARK: f32 = 0.4;

/// The colours of a world's parts.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct Palette {
    /// Walls, partitions and kerbs.
    pub wall: Color,
    /// Trees.
    pub tree: Color,
    /// Roads.
    pub road: Color,
    /// Floors of lit rooms.
    pub room: Color,
    /// Floors of dark rooms.
    pub dark_room: Color,
    /// Openings in walls.
    pub doorway: Color,
    /// Obstacles.
    pub obstacle: Color,
    /// Uneven ground and debris.
    pub rough: Color,
    /// Water.
    pub water: Color,
    /// Plain floors of hallways and open areas.
    pub floor: Color,
    /// Slippery floors.
    pub slippery: Color,
    /// Loose ground.
    pub loose: Color,
    /// Walls and obstacles that lasers see only from near.
    pub dark: Color,
    /// The start.
    pub start: Color,
    /// The goal.
    pub goal: Color,
    /// People to be found.
    pub victim: Color,
    /// People of scenarios.
    pub person: Color,
    /// Where they look.
    pub face: Color,
    /// The leaves of doors.
    pub leaf: Color,
    /// Smoke; its opacity follows from its extinction.
    pub smoke: Color,
    /// The classes of a landscape from 1 on; repeated when there are more classes than colours.
    pub classes: Vec<Color>,
}

/// The colours of [`envgen::palette`], which the SVG and PNG pictures have too.
impl Default for Palette {
    fn default() -> Self {
        use envgen::world::{ObstacleKind, SurfaceKind, WallKind};
        Palette {
            wall: color(palette::wall(WallKind::Wall).fill),
            tree: color(palette::TREE.fill),
            road: color(palette::ROAD.fill),
            room: color(palette::room_floor(None, true)),
            dark_room: color(palette::room_floor(None, false)),
            doorway: color(palette::OPEN_DOORWAY.fill),
            obstacle: color(palette::obstacle(ObstacleKind::Other).fill),
            rough: color(palette::surface(SurfaceKind::Uneven).fill),
            water: color(palette::surface(SurfaceKind::Water).fill),
            floor: color(palette::surface(SurfaceKind::Hallway).fill),
            // See-through, since they cover whole rooms, whose colours count as well.
            slippery: color(palette::surface(SurfaceKind::Slippery).fill).with_alpha(0.35),
            loose: color(palette::surface(SurfaceKind::Loose).fill).with_alpha(0.35),
            dark: color(palette::DARK.fill),
            start: color(palette::START),
            goal: color(palette::GOAL),
            victim: color(palette::VICTIM.fill),
            person: color(palette::PERSON.fill),
            face: color(palette::INK),
            leaf: color(palette::LEAF.fill),
            smoke: color(palette::SMOKE.fill),
            classes: (1..=palette::CLASSES).map(|class| color(palette::class(class))).collect(),
        }
    }
}

/// A colour of [`envgen::palette`], opaque.
pub fn color(Srgb([red, green, blue]): Srgb) -> Color {
    Color::srgb_u8(red, green, blue)
}

/// Draws the parts of worlds: one mesh per tile and colour, as children of the tile. People, leaves and smoke of
/// scenarios have meshes as children.
///
/// Needs Bevy's plugins for meshes and `ColorMaterial`s; without them it draws nothing. No other
/// plugin depends on it.
#[derive(Clone, Debug, Default)]
pub struct EnvgenVisualsPlugin {
    palette: Palette,
}

impl EnvgenVisualsPlugin {
    /// Uses `palette` instead of the default colours.
    pub fn new(palette: Palette) -> Self {
        EnvgenVisualsPlugin { palette }
    }
}

impl Plugin for EnvgenVisualsPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Palette>()
            .insert_resource(self.palette.clone())
            .init_resource::<Inks>()
            .add_observer(draw)
            .add_observer(moving::draw_person)
            .add_observer(moving::draw_leaf)
            .add_observer(moving::draw_smoke);
        let main = Schedules::of(app).main;
        app.add_systems(
            main,
            (moving::stretch_leaves, moving::fade_smoke).after(EnvgenSystems::Notify),
        );
        require_visibility(app);
    }
}

/// Requires [`Visibility`] for environments, tiles, parts and what moves, so that an app can hide them: Bevy hides the
/// children of an entity without it. Another plugin may have required it before: that is no error.
pub fn require_visibility(app: &mut App) {
    app.try_register_required_components::<Environment, Visibility>().ok();
    app.try_register_required_components::<Tile, Visibility>().ok();
    app.try_register_required_components::<PartId, Visibility>().ok();
    app.try_register_required_components::<Person, Visibility>().ok();
    app.try_register_required_components::<Door, Visibility>().ok();
    app.try_register_required_components::<DoorLeaf, Visibility>().ok();
    app.try_register_required_components::<Smoke, Visibility>().ok();
}

/// The groups of parts with one colour, from the lowest layer to the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Ink {
    Class(u16),
    Floor,
    Slippery,
    Loose,
    Rough,
    Water,
    DarkRoom,
    Room,
    Road,
    Doorway,
    Wall,
    Tree,
    Obstacle,
    Dark,
    Start,
    Goal,
    Victim,
    Leaf,
    Person,
    Face,
}

impl Ink {
    fn layer(self) -> f32 {
        let order = match self {
            Ink::Class(_) => 0.0,
            Ink::Floor => 1.0,
            Ink::Slippery => 1.6,
            Ink::Loose => 1.8,
            Ink::Rough => 2.0,
            Ink::Water => 3.0,
            Ink::DarkRoom | Ink::Room => 1.5,
            Ink::Road => 4.0,
            Ink::Doorway => 5.0,
            Ink::Wall => 6.0,
            Ink::Tree => 7.0,
            Ink::Obstacle | Ink::Dark => 8.0,
            Ink::Start | Ink::Goal | Ink::Victim => 9.0,
            Ink::Leaf => 9.5,
            Ink::Person => 10.0,
            Ink::Face => 10.5,
        };
        order * LAYER
    }

    fn color(self, palette: &Palette) -> Color {
        match self {
            Ink::Class(class) => {
                let classes = palette.classes.len().max(1);
                let place = usize::from(class.max(1) - 1) % classes;
                palette.classes.get(place).copied().unwrap_or(palette.floor)
            }
            Ink::Floor => palette.floor,
            Ink::Slippery => palette.slippery,
            Ink::Loose => palette.loose,
            Ink::Rough => palette.rough,
            Ink::Water => palette.water,
            Ink::DarkRoom => palette.dark_room,
            Ink::Room => palette.room,
            Ink::Road => palette.road,
            Ink::Doorway => palette.doorway,
            Ink::Wall => palette.wall,
            Ink::Tree => palette.tree,
            Ink::Obstacle => palette.obstacle,
            Ink::Dark => palette.dark,
            Ink::Start => palette.start,
            Ink::Goal => palette.goal,
            Ink::Victim => palette.victim,
            Ink::Leaf => palette.leaf,
            Ink::Person => palette.person,
            Ink::Face => palette.face,
        }
    }
}

/// The materials of the inks used so far, shared by all environments, with the colours that they
/// were made from.
#[derive(Resource, Default)]
struct Inks(BTreeMap<Ink, (Color, Handle<ColorMaterial>)>);

/// A mesh in the environment's frame.
#[derive(Default)]
struct Drawing {
    corners: Vec<[f32; 3]>,
    triangles: Vec<u32>,
}

impl Drawing {
    fn add(&mut self, corners: impl IntoIterator<Item = Vec2>, triangles: &[[u32; 3]]) {
        let first = self.corners.len() as u32;
        self.corners.extend(corners.into_iter().map(|p| [p.x, p.y, 0.0]));
        self.triangles.extend(triangles.iter().flatten().map(|corner| first + corner));
    }

    fn add_shape(&mut self, transform: &Transform, shape: &PartShape) {
        let place = |p: Vec2| transform.transform_point(p.extend(0.0)).truncate();
        let mut polygon = |corners: &[Vec2]| {
            self.add(corners.iter().copied().map(place), &triangles(corners));
        };
        match shape {
            PartShape::Disc { radius } => {
                let sides = (8.0 * (1.0 + radius.sqrt())).clamp(8.0, 48.0).round() as u32;
                let corner = |i: u32| Vec2::from_angle(TAU * i as f32 / sides as f32) * *radius;
                let fan: Vec<_> = (2..sides).map(|i| [0, i - 1, i]).collect();
                self.add((0..sides).map(corner).map(place), &fan);
            }
            PartShape::Box { half_size: h } => {
                polygon(&[-*h, Vec2::new(h.x, -h.y), *h, Vec2::new(-h.x, h.y)]);
            }
            PartShape::Polygon { vertices } => polygon(vertices),
            // An arrow along the heading.
            PartShape::Point => polygon(&[
                Vec2::new(-0.5 * MARK, -0.5 * MARK),
                Vec2::new(MARK, 0.0),
                Vec2::new(-0.5 * MARK, 0.5 * MARK),
            ]),
            PartShape::Segment { .. } | PartShape::Strip { .. } => {}
        }
    }

    fn into_mesh(self) -> Mesh {
        let normals = vec![[0.0, 0.0, 1.0]; self.corners.len()];
        Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.corners)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
            .with_inserted_indices(Indices::U32(self.triangles))
    }
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
    let palette = world.get_resource::<Palette>().cloned().unwrap_or_default();
    for (ink, drawing) in drawings(world, spawned) {
        let Some(material) = material(world, ink, ink.color(&palette)) else { return };
        let Some(mut meshes) = world.get_resource_mut::<Assets<Mesh>>() else { return };
        let mesh = meshes.add(drawing.into_mesh());
        world.spawn((
            Name::new(format!("{ink:?}")),
            Mesh2d(mesh),
            MeshMaterial2d(material),
            Transform::from_xyz(0.0, 0.0, ink.layer()),
            ChildOf(spawned.tile),
        ));
    }
}

fn material(world: &mut World, ink: Ink, color: Color) -> Option<Handle<ColorMaterial>> {
    if let Some((known, handle)) = world.resource::<Inks>().0.get(&ink)
        && *known == color
    {
        return Some(handle.clone());
    }
    let handle = world.get_resource_mut::<Assets<ColorMaterial>>()?.add(color);
    world.resource_mut::<Inks>().0.insert(ink, (color, handle.clone()));
    Some(handle)
}

/// The parts of a tile as triangles, by ink.
fn drawings(world: &World, spawned: &TileSpawned) -> BTreeMap<Ink, Drawing> {
    let mut drawings: BTreeMap<Ink, Drawing> = BTreeMap::new();
    for &part in &spawned.parts {
        let Ok(part) = world.get_entity(part) else { continue };
        let (Some(id), Some(at), Some(shape)) =
            (part.get::<PartId>(), part.get::<Transform>(), part.get::<PartShape>())
        else {
            continue;
        };
        let ink = match id.kind {
            PartKind::Ground => {
                if let Some(ground) = part.get::<Ground>() {
                    for (class, corners) in class_rectangles(at, shape, ground) {
                        let drawing = drawings.entry(Ink::Class(class)).or_default();
                        drawing.add(corners, &[[0, 1, 2], [0, 2, 3]]);
                    }
                }
                continue;
            }
            PartKind::RoadStrip => {
                let drawing = drawings.entry(Ink::Road).or_default();
                add_road(drawing, world, spawned.environment, *id);
                continue;
            }
            // Drawn below, together with those that are data.
            PartKind::Wall | PartKind::Tree | PartKind::Obstacle => continue,
            PartKind::Room if part.get::<Room>().is_some_and(|room| !room.lit) => Ink::DarkRoom,
            PartKind::Room => Ink::Room,
            PartKind::Doorway => Ink::Doorway,
            PartKind::Surface => match part.get::<Surface>().map(|surface| surface.kind) {
                Some(SurfaceKind::Water) => Ink::Water,
                Some(SurfaceKind::Hallway | SurfaceKind::OpenArea) => Ink::Floor,
                Some(SurfaceKind::Slippery) => Ink::Slippery,
                Some(SurfaceKind::Loose) => Ink::Loose,
                // Drawn by its ground.
                Some(SurfaceKind::Class(_)) => continue,
                _ => Ink::Rough,
            },
            PartKind::Start => Ink::Start,
            PartKind::Goal => Ink::Goal,
            PartKind::Victim => Ink::Victim,
        };
        drawings.entry(ink).or_default().add_shape(at, shape);
    }
    let truth = world.get::<GroundTruth>(spawned.environment);
    let is_dark = |id: &PartId| {
        let part = truth.zip(id.in_world());
        part.is_some_and(|(truth, part)| truth.visible_range(part).is_some())
    };
    for (id, at, shape) in spawned.placed(world) {
        let ink = match id.kind {
            PartKind::Wall | PartKind::Obstacle if is_dark(&id) => Ink::Dark,
            PartKind::Wall => Ink::Wall,
            PartKind::Tree => Ink::Tree,
            PartKind::Obstacle => Ink::Obstacle,
            _ => continue,
        };
        drawings.entry(ink).or_default().add_shape(at, shape);
    }
    drawings.retain(|_, drawing| !drawing.triangles.is_empty());
    drawings
}

/// Adds the exact surface of a road, from the world itself.
fn add_road(drawing: &mut Drawing, world: &World, environment: Entity, id: PartId) {
    let truth = world.get::<GroundTruth>(environment);
    let origin = world.get::<Environment>(environment).map(|environment| environment.origin);
    let (Some(truth), Some(origin)) = (truth, origin) else { return };
    let Some(strip) = truth.road_strips.get(id.index as usize) else { return };
    let mesh = strip.mesh(ROAD_TOLERANCE);
    drawing.add(mesh.vertices.iter().map(|v| (*v - origin).as_vec2()), &mesh.triangles);
}
