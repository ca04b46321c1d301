//! Spawns the parts of worlds as entities.

use bevy::ecs::bundle::NoBundleEffect;
use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::geometry::Pose;
use envgen::glam::DVec2;

use crate::environment::{Environment, SolidStorage, TileLayout};
use crate::height::HeightRange;
use crate::part::{
    Doorway, Goal, Ground, Obstacle, PartId, PartKind, PartOf, RoadStrip, Room, Start, Surface,
    Tree, Victim, Wall,
};
use crate::place::global_transform;
use crate::plan::{PartRef, Plan, TileKey, block_cells};
use crate::shape::{LocalFrame, PartShape};

/// The largest distance in metres between the edges of a road, of which points are joined by lines, and its exact edges.
pub(crate) const ROAD_TOLERANCE: f64 = 0.01;

/// A component of a group of neighbouring parts. It is on an entity between the environment and the parts,
/// and the parts are spawned and despawned together with it.
///
/// The transform of the tile is the identity, so that the [`Transform`] of a part is its pose in the frame of
/// the environment.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct Tile {
    /// The number of times that the side of the smallest tiles is doubled. Tiles of a higher level contain
    /// parts that are longer than the side of a smaller tile.
    pub level: u8,
    /// The column and the row in the grid of that level.
    pub at: [i32; 2],
    /// The index of this entity among those of the same tile, since tiles with many parts are split.
    pub page: u32,
}

/// A component with the solid parts of a [`Tile`] that are stored as data instead of as entities, in the
/// order of their ids; see [`SolidStorage::TileData`]. It is on the entity of the tile.
#[derive(Component, Clone, Debug, Default, PartialEq, Deref, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TileSolids(pub Vec<SolidPart>);

/// A solid part that is stored as data of its tile. [`PartId::in_world`] is the key of its other properties
/// in the [`GroundTruth`](crate::GroundTruth).
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Debug, PartialEq, Clone)]
pub struct SolidPart {
    /// The stable id of the part.
    pub id: PartId,
    /// The pose of the part in the frame of the environment.
    pub transform: Transform,
    /// The shape of the part.
    pub shape: PartShape,
    /// The bottom and the top of the part. Every solid part has them.
    pub height: Option<HeightRange>,
}

/// An event that is triggered on an environment for every [`Tile`] that is spawned, before the environment is
/// reported ready. Observers can add components to the tile and its parts.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// #[derive(Component)]
/// struct Health(f32);
///
/// fn plant(spawned: On<TileSpawned>, trees: Query<(Entity, &Tree)>, mut commands: Commands) {
///     for (entity, tree) in trees.iter_many(&spawned.parts) {
///         commands.entity(entity).insert(Health(10.0 * tree.radius));
///     }
/// }
/// # let mut app = bevy_envgen::testing::test_app();
/// # app.add_observer(plant);
/// # let forest = Environment::new(ForestSpec::default(), 1);
/// # bevy_envgen::testing::spawn_ready(&mut app, forest).unwrap();
/// # assert!(app.world_mut().query::<&Health>().iter(app.world()).count() > 100);
/// ```
///
/// The order of observers is not defined. In a streamed world the time of the observers and their commands
/// counts towards the [`StreamingBudget`](crate::StreamingBudget) of the frame. Systems between
/// [`EnvgenSystems::Stream`](crate::EnvgenSystems) and `Notify` see all tiles of the frame, with everything
/// that observers have added, and can find the new tiles with `Added<Tile>`.
#[derive(EntityEvent, Clone, Debug)]
pub struct TileSpawned {
    /// The entity of the environment.
    #[event_target]
    pub environment: Entity,
    /// The entity of the tile.
    pub tile: Entity,
    /// The entities of the parts of the tile, in the order of their ids. Parts that are stored as data are in
    /// the [`TileSolids`] of the tile.
    pub parts: Vec<Entity>,
}

impl TileSpawned {
    /// Returns all parts of the tile, both entities and data, with their poses in the frame of the
    /// environment.
    pub fn placed<'w>(
        &'w self,
        world: &'w World,
    ) -> impl Iterator<Item = (PartId, &'w Transform, &'w PartShape)> {
        let entities = self.parts.iter().filter_map(|&part| {
            let part = world.get_entity(part).ok()?;
            Some((*part.get::<PartId>()?, part.get::<Transform>()?, part.get::<PartShape>()?))
        });
        let data = world.get::<TileSolids>(self.tile).map_or(&[][..], |solids| &solids.0);
        entities.chain(data.iter().map(|part| (part.id, &part.transform, &part.shape)))
    }

    /// Returns the solid parts of the tile, both entities and data, with their heights.
    #[cfg(feature = "physics")]
    pub(crate) fn solids<'w>(
        &'w self,
        world: &'w World,
    ) -> impl Iterator<Item = (&'w Transform, &'w PartShape, Option<HeightRange>)> {
        let entities = self.parts.iter().filter_map(|&part| {
            let part = world.get_entity(part).ok()?;
            let is_solid = part.get::<PartId>()?.kind.is_solid();
            let height = part.get::<HeightRange>().copied();
            is_solid.then_some((part.get::<Transform>()?, part.get::<PartShape>()?, height))
        });
        let data = world.get::<TileSolids>(self.tile).map_or(&[][..], |solids| &solids.0);
        entities.chain(data.iter().map(|part| (&part.transform, &part.shape, part.height)))
    }
}

/// The ancestors of the parts of a tile, and their global transform.
#[derive(Clone, Copy)]
struct Ancestors {
    environment: Entity,
    tile: Entity,
    global: GlobalTransform,
}

/// Spawns one page of a tile of a finite world. Returns `None` if the environment no longer exists.
pub(crate) fn spawn_page(
    world: &mut World,
    environment: Entity,
    layout: TileLayout,
    plan: &Plan,
    key: TileKey,
    page: usize,
) -> Option<Entity> {
    let parts = plan.tiles.get(&key)?.parts.chunks(plan.page).nth(page)?;
    let ancestors = spawn_tile(world, environment, key, page)?;
    let frame = LocalFrame::new(layout.origin);
    let mut entities = Vec::new();
    let mut solids = Vec::new();
    for run in parts.chunk_by(|a, b| a.kind == b.kind) {
        // An observer of the tile or its parts may have despawned it. Parts without it would never be removed.
        if world.get_entity(ancestors.tile).is_err() {
            break;
        }
        if layout.solids == SolidStorage::TileData && run[0].kind.is_solid() {
            solids.extend(run.iter().filter_map(|&part| solid(frame, &plan.world, part)));
        } else {
            spawn_run(world, &mut entities, ancestors, frame, plan, run);
        }
    }
    store_solids(world, ancestors.tile, solids);
    trigger_spawned(world, ancestors, entities);
    Some(ancestors.tile)
}

/// Spawns some trees of a tile of an endless forest. `first` is the index of the first tree. Returns `None`
/// if the environment no longer exists.
pub(crate) fn spawn_trees(
    world: &mut World,
    environment: Entity,
    layout: TileLayout,
    key: TileKey,
    (first, trees): (usize, &[envgen::world::Tree]),
    page: usize,
) -> Option<Entity> {
    let ancestors = spawn_tile(world, environment, key, page)?;
    let frame = LocalFrame::new(layout.origin);
    let id = |index| PartId { kind: PartKind::Tree, tile: key.at, index };
    let trees = (first as u32..).map(id).zip(trees);
    let parts = match layout.solids {
        // An observer of the tile has despawned it.
        _ if world.get_entity(ancestors.tile).is_err() => Vec::new(),
        SolidStorage::Entities => world
            .spawn_batch(trees.map(|(id, tree)| {
                let component = Tree { radius: tree.radius as f32 };
                part(
                    ancestors,
                    id,
                    place_tree(frame, tree),
                    (component, HeightRange::from(tree.extent())),
                )
            }))
            .collect(),
        SolidStorage::TileData => {
            let solids = trees.map(|(id, tree)| {
                let (transform, shape) = place_tree(frame, tree);
                let height = Some(tree.extent().into());
                SolidPart { id, transform, shape, height }
            });
            store_solids(world, ancestors.tile, solids.collect());
            Vec::new()
        }
    };
    trigger_spawned(world, ancestors, parts);
    Some(ancestors.tile)
}

/// Spawns a tile without its parts. Returns `None` if an observer has despawned or removed the environment.
fn spawn_tile(
    world: &mut World,
    environment: Entity,
    key: TileKey,
    page: usize,
) -> Option<Ancestors> {
    world.get::<Environment>(environment)?;
    let TileKey { level, at: [i, j] } = key;
    let name = Name::new(format!("tile ({i}, {j})"));
    let tile = Tile { level, at: key.at, page: page as u32 };
    // This is correct at once, before Bevy propagates transforms.
    let global = global_transform(world, environment).mul_transform(Transform::IDENTITY);
    let tile = world.spawn((tile, name, global, ChildOf(environment))).id();
    Some(Ancestors { environment, tile, global })
}

/// Stores solid parts as data of a tile, if it still exists.
fn store_solids(world: &mut World, tile: Entity, solids: Vec<SolidPart>) {
    if let Ok(mut tile) = world.get_entity_mut(tile)
        && !solids.is_empty()
    {
        tile.insert(TileSolids(solids));
    }
}

/// Returns a solid part as data, or `None` for parts of other kinds.
fn solid(frame: LocalFrame, truth: &EnvgenWorld, part: PartRef) -> Option<SolidPart> {
    let i = part.index as usize;
    let ((transform, shape), extent) = match part.kind {
        PartKind::Wall => (frame.place(&truth.walls[i].shape), truth.walls[i].extent()),
        PartKind::Obstacle => (frame.place(&truth.obstacles[i].shape), truth.obstacles[i].extent()),
        PartKind::Tree => (place_tree(frame, &truth.trees[i]), truth.trees[i].extent()),
        _ => return None,
    };
    let id = PartId::new(part.kind, part.index);
    Some(SolidPart { id, transform, shape, height: Some(extent.into()) })
}

/// Triggers [`TileSpawned`], so that observers can add components to the new parts of a tile that still exists.
fn trigger_spawned(world: &mut World, ancestors: Ancestors, parts: Vec<Entity>) {
    let Ancestors { environment, tile, .. } = ancestors;
    if world.get_entity(tile).is_err() {
        return;
    }
    world.trigger(TileSpawned { environment, tile, parts });
    world.flush();
}

/// Returns the components of a part: those of all parts, and those of its kind.
fn part<P: Bundle<Effect: NoBundleEffect>>(
    ancestors: Ancestors,
    id: PartId,
    (transform, shape): (Transform, PartShape),
    part: P,
) -> impl Bundle<Effect: NoBundleEffect> {
    let global = ancestors.global.mul_transform(transform);
    let belongs = (ChildOf(ancestors.tile), PartOf(ancestors.environment));
    (id, Name::new(name(id)), belongs, transform, global, shape, part)
}

/// Returns the id as text. It avoids `format!`, since naming the parts is a large share of the cost of
/// spawning.
fn name(id: PartId) -> String {
    if id.tile != [0, 0] {
        return id.to_string();
    }
    let (mut digits, mut rest) = ([0; 10], id.index);
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] = b'0' + (rest % 10) as u8;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    let kind = id.kind.name();
    let mut name = String::with_capacity(kind.len() + 1 + digits.len());
    name.push_str(kind);
    name.push(' ');
    name.extend(digits[first..].iter().map(|&digit| char::from(digit)));
    name
}

fn place_tree(frame: LocalFrame, tree: &envgen::world::Tree) -> (Transform, PartShape) {
    (frame.pose(tree.center, 0.0), PartShape::Disc { radius: tree.radius as f32 })
}

/// Spawns parts of one kind.
fn spawn_run(
    world: &mut World,
    entities: &mut Vec<Entity>,
    ancestors: Ancestors,
    frame: LocalFrame,
    plan: &Plan,
    run: &[PartRef],
) {
    let Some(&PartRef { kind, .. }) = run.first() else { return };
    let truth: &EnvgenWorld = &plan.world;
    // The plan holds an `Arc` of the world, so its parts outlive the borrow of the ECS.
    let ids = run.iter().map(|part| part.index as usize);
    let pose = |pose: &Pose| (frame.pose(pose.position, pose.heading), PartShape::Point);
    macro_rules! spawn {
        ($i:ident => $placed:expr) => {
            entities.extend(world.spawn_batch(ids.map(|$i| {
                let (place, component) = $placed;
                part(ancestors, PartId::new(kind, $i as u32), place, component)
            })))
        };
    }
    match kind {
        PartKind::Wall => spawn!(i => {
            let wall = &truth.walls[i];
            let visible_range = wall.visible_range.map(|range| range as f32);
            let part = Wall { kind: wall.kind, visible_range };
            (frame.place(&wall.shape), (part, HeightRange::from(wall.extent())))
        }),
        PartKind::Tree => spawn!(i => {
            let tree = &truth.trees[i];
            let part = Tree { radius: tree.radius as f32 };
            (place_tree(frame, tree), (part, HeightRange::from(tree.extent())))
        }),
        PartKind::RoadStrip => spawn!(i => {
            let strip = &truth.road_strips[i];
            let (place, part) = road(frame, strip);
            (place, (part, HeightRange::from(strip.extent())))
        }),
        PartKind::Room => spawn!(i => {
            let room = &truth.rooms[i];
            let difficulty = room.difficulty.map(|difficulty| difficulty as f32);
            let (name, contents) = (room.name.clone(), room.contents);
            let part = Room { name, difficulty, lit: room.lit, contents };
            (frame.place(&room.shape), (part, HeightRange::from(room.extent())))
        }),
        PartKind::Doorway => spawn!(i => {
            let doorway = &truth.doorways[i];
            let part = Doorway { open: doorway.open, rooms: doorway.rooms };
            (frame.place(&doorway.shape), (part, HeightRange::from(doorway.extent())))
        }),
        PartKind::Obstacle => spawn!(i => {
            let obstacle = &truth.obstacles[i];
            let visible_range = obstacle.visible_range.map(|range| range as f32);
            let part = Obstacle { kind: obstacle.kind, visible_range };
            (frame.place(&obstacle.shape), (part, HeightRange::from(obstacle.extent())))
        }),
        PartKind::Surface => spawn!(i => {
            let surface = &truth.surfaces[i];
            let part = Surface {
                kind: surface.kind,
                speed: surface.speed as f32,
                odometry_noise: surface.odometry_noise as f32,
                wheel_bias: surface.wheel_bias as f32,
            };
            (frame.place(&surface.shape), (part, HeightRange::from(surface.extent())))
        }),
        PartKind::Start => spawn!(i => (pose(&truth.start.unwrap_or_default()), Start)),
        PartKind::Goal => spawn!(i => (pose(&truth.goal.unwrap_or_default()), Goal)),
        PartKind::Victim => spawn!(i => (pose(&truth.victims[i]), Victim)),
        PartKind::Ground => spawn!(i => ground(frame, truth, plan.block, i as u32)),
    }
}

fn road(
    frame: LocalFrame,
    strip: &envgen::world::RoadStrip,
) -> ((Transform, PartShape), RoadStrip) {
    let mut points = strip.line(0.0, ROAD_TOLERANCE);
    if strip.closed
        && points.len() > 2
        && points[0].distance(points[points.len() - 1]) < ROAD_TOLERANCE
    {
        points.pop();
    }
    let (transform, centreline) = frame.around(&points);
    let (width, lanes, closed) = (strip.width as f32, strip.lanes, strip.closed);
    let shape = PartShape::Strip { centreline, width, closed };
    ((transform, shape), RoadStrip { width, lanes, closed })
}

fn ground(
    frame: LocalFrame,
    truth: &EnvgenWorld,
    block: u32,
    index: u32,
) -> ((Transform, PartShape), Ground) {
    let Some(raster) = &truth.raster else {
        unreachable!("only a world with cells has blocks of them")
    };
    let [row, col, rows, cols] = block_cells(raster.rows, raster.cols, block, index);
    let size = DVec2::new(f64::from(cols), f64::from(rows)) * raster.cell;
    let low = DVec2::new(f64::from(col), f64::from(raster.rows - row - rows)) * raster.cell;
    let transform = frame.pose(raster.origin + low + 0.5 * size, 0.0);
    let classes = (row..row + rows)
        .flat_map(|r| {
            let start = r as usize * raster.cols as usize + col as usize;
            raster.cells[start..start + cols as usize].iter().copied()
        })
        .collect();
    let half_size = (0.5 * size).as_vec2();
    let cell = raster.cell as f32;
    ((transform, PartShape::Box { half_size }), Ground { row, col, cols, cell, classes })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_ids_as_text() {
        for index in [0, 7, 10, 4_294_967_295, 1_234_567_890] {
            for tile in [[0, 0], [3, -4]] {
                let id = PartId { kind: PartKind::RoadStrip, tile, index };
                assert_eq!(name(id), id.to_string());
            }
        }
    }

    #[test]
    fn strips_follow_the_exact_curves_of_roads() {
        use envgen::road::{Prefab, RoadSpec};
        use envgen::{Blueprint, Seed, Spec};

        let open = RoadSpec { step: 60.0, transition: 0.3, ..Default::default() };
        let closed = RoadSpec {
            prefabs: [Prefab::Straight, Prefab::Left].repeat(4),
            closed: true,
            speed: 5.0,
            ..open.clone()
        };
        for spec in [open, closed] {
            let world = spec.generate(Seed(3)).unwrap().to_world();
            let strip = &world.road_strips[0];
            let ((at, shape), _) = road(LocalFrame::new(DVec2::ZERO), strip);
            let PartShape::Strip { centreline, closed, .. } = shape else { panic!("{shape:?}") };
            let mut line: Vec<DVec2> = centreline
                .iter()
                .map(|p| at.transform_point(p.extend(0.0)).truncate().as_dvec2())
                .collect();
            assert!(line[0].distance(line[line.len() - 1]) > 0.1);
            line.extend(closed.then_some(line[0]));
            for s in 0..=1000 {
                let p = strip.path().pose_at(f64::from(s)).position;
                let away = line
                    .windows(2)
                    .map(|pair| envgen::geometry::distance_to_segment(p, pair[0], pair[1]))
                    .fold(f64::INFINITY, f64::min);
                assert!(away < ROAD_TOLERANCE + 1e-3, "{away} m at {s} m");
            }
        }
    }
}
