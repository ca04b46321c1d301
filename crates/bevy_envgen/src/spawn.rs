//! From a world's parts to entities.

use bevy::ecs::bundle::NoBundleEffect;
use bevy::prelude::*;
use envgen::World as EnvgenWorld;
use envgen::geometry::Pose;
use envgen::glam::DVec2;

use crate::environment::{Layout, SolidStorage};
use crate::part::{
    Doorway, Goal, Ground, Obstacle, PartId, PartKind, PartOf, RoadStrip, Room, Start, Surface,
    Tree, Victim, Wall,
};
use crate::place::global_transform;
use crate::plan::{PartRef, Plan, TileKey, block_cells};
use crate::shape::{Frame, PartShape};

/// A group of neighbouring parts: the entity between an environment and its parts, which come and
/// go with it.
///
/// Its transform is the identity, so that a part's [`Transform`] is where the part lies in the
/// environment's frame.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
#[require(Transform)]
pub struct Tile {
    /// How often the side of the smallest tiles is doubled: tiles of a higher level hold parts that
    /// are longer than that side.
    pub level: u8,
    /// The place in the grid of that level.
    pub at: [i32; 2],
    /// Tiles of many parts are split.
    pub page: u32,
}

/// The solid parts of a [`Tile`] that are data and not entities, in the order of their ids: see
/// [`SolidStorage::TileData`]. On the entity of the tile.
#[derive(Component, Clone, Debug, Default, PartialEq, Deref, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct TileSolids(pub Vec<SolidPart>);

/// A part that stands, and where it lies. What else is known of it the [`GroundTruth`](crate::GroundTruth)
/// tells, by [`PartId::in_world`].
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Debug, PartialEq, Clone)]
pub struct SolidPart {
    /// Its stable name.
    pub id: PartId,
    /// Where it lies in the environment's frame.
    pub transform: Transform,
    /// What it looks like.
    pub shape: PartShape,
}

/// Triggered on an environment for every [`Tile`] as it is spawned, before the environment is reported
/// ready: the place to add something to its parts, or to the tile itself.
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
/// Observers run in no particular order. What they and their commands do in a streamed world counts
/// towards the frame's [`StreamingBudget`](crate::StreamingBudget). Systems between
/// [`EnvgenSystems::Stream`](crate::EnvgenSystems) and `Notify` see all tiles of the frame, with all
/// that observers added, and find the new ones by `Added<Tile>`.
#[derive(EntityEvent, Clone, Debug)]
pub struct TileSpawned {
    /// The entity of the environment.
    #[event_target]
    pub environment: Entity,
    /// The entity of the tile.
    pub tile: Entity,
    /// The entities of the parts in it, in the order of their ids. Parts that are data are in the
    /// [`TileSolids`] of the tile.
    pub parts: Vec<Entity>,
}

impl TileSpawned {
    /// All parts in the tile, entities and data, and where they lie.
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
}

/// What the parts of a tile are spawned below.
#[derive(Clone, Copy)]
struct Above {
    environment: Entity,
    tile: Entity,
    global: GlobalTransform,
}

/// Spawns one page of a tile of a finite world; `None` when the environment is gone.
pub(crate) fn spawn_page(
    world: &mut World,
    environment: Entity,
    layout: Layout,
    plan: &Plan,
    key: TileKey,
    page: usize,
) -> Option<Entity> {
    let parts = plan.tiles.get(&key)?.parts.chunks(plan.page).nth(page)?;
    let above = spawn_tile(world, environment, key, page)?;
    let frame = Frame::new(layout.origin);
    let mut entities = Vec::new();
    let mut solids = Vec::new();
    for run in parts.chunk_by(|a, b| a.kind == b.kind) {
        if layout.solids == SolidStorage::TileData && run[0].kind.is_solid() {
            solids.extend(run.iter().filter_map(|&part| solid(frame, &plan.world, part)));
        } else {
            spawn_run(world, &mut entities, above, frame, plan, run);
        }
    }
    keep(world, above.tile, solids);
    tell(world, above, entities);
    Some(above.tile)
}

/// Spawns some of the trees of a tile of an endless forest, of which `first` is the index of the first;
/// `None` when the environment is gone.
pub(crate) fn spawn_trees(
    world: &mut World,
    environment: Entity,
    layout: Layout,
    key: TileKey,
    (first, trees): (usize, &[envgen::world::Tree]),
    page: usize,
) -> Option<Entity> {
    let above = spawn_tile(world, environment, key, page)?;
    let frame = Frame::new(layout.origin);
    let id = |index| PartId { kind: PartKind::Tree, tile: key.at, index };
    let trees = (first as u32..).map(id).zip(trees);
    let parts = match layout.solids {
        SolidStorage::Entities => world
            .spawn_batch(trees.map(|(id, tree)| {
                part(above, id, place_tree(frame, tree), Tree { radius: tree.radius as f32 })
            }))
            .collect(),
        SolidStorage::TileData => {
            let solids = trees.map(|(id, tree)| {
                let (transform, shape) = place_tree(frame, tree);
                SolidPart { id, transform, shape }
            });
            keep(world, above.tile, solids.collect());
            Vec::new()
        }
    };
    tell(world, above, parts);
    Some(above.tile)
}

/// Spawns a tile without its parts; `None` when an observer has despawned the environment.
fn spawn_tile(world: &mut World, environment: Entity, key: TileKey, page: usize) -> Option<Above> {
    world.get_entity(environment).ok()?;
    let TileKey { level, at: [i, j] } = key;
    let name = Name::new(format!("tile ({i}, {j})"));
    let tile = Tile { level, at: key.at, page: page as u32 };
    // What is spawned is where it belongs at once, whenever Bevy propagates transforms.
    let global = global_transform(world, environment).mul_transform(Transform::IDENTITY);
    let tile = world.spawn((tile, name, global, ChildOf(environment))).id();
    Some(Above { environment, tile, global })
}

/// Keeps solid parts as data of a tile.
fn keep(world: &mut World, tile: Entity, solids: Vec<SolidPart>) {
    if !solids.is_empty() {
        world.entity_mut(tile).insert(TileSolids(solids));
    }
}

/// A solid part as data; `None` for parts of other kinds.
fn solid(frame: Frame, truth: &EnvgenWorld, part: PartRef) -> Option<SolidPart> {
    let i = part.index as usize;
    let (transform, shape) = match part.kind {
        PartKind::Wall => frame.place(&truth.walls[i].shape),
        PartKind::Obstacle => frame.place(&truth.obstacles[i].shape),
        PartKind::Tree => place_tree(frame, &truth.trees[i]),
        _ => return None,
    };
    Some(SolidPart { id: PartId::new(part.kind, part.index), transform, shape })
}

/// Lets others add to what was spawned.
fn tell(world: &mut World, above: Above, parts: Vec<Entity>) {
    let Above { environment, tile, .. } = above;
    world.trigger(TileSpawned { environment, tile, parts });
    world.flush();
}

/// A part as components: what every part has, and what its kind has.
fn part<P: Component>(
    above: Above,
    id: PartId,
    (transform, shape): (Transform, PartShape),
    part: P,
) -> impl Bundle<Effect: NoBundleEffect> {
    let global = above.global.mul_transform(transform);
    let belongs = (ChildOf(above.tile), PartOf(above.environment));
    (id, Name::new(name(id)), belongs, transform, global, shape, part)
}

/// The id as text. Most ids are short, and formatting them is much of what spawning costs.
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

fn place_tree(frame: Frame, tree: &envgen::world::Tree) -> (Transform, PartShape) {
    (frame.pose(tree.center, 0.0), PartShape::Disc { radius: tree.radius as f32 })
}

/// Spawns parts of one kind.
fn spawn_run(
    world: &mut World,
    entities: &mut Vec<Entity>,
    above: Above,
    frame: Frame,
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
                part(above, PartId::new(kind, $i as u32), place, component)
            })))
        };
    }
    match kind {
        PartKind::Wall => spawn!(i => {
            let wall = &truth.walls[i];
            (frame.place(&wall.shape), Wall { kind: wall.kind.into() })
        }),
        PartKind::Tree => spawn!(i => {
            let tree = &truth.trees[i];
            (place_tree(frame, tree), Tree { radius: tree.radius as f32 })
        }),
        PartKind::RoadStrip => spawn!(i => road(frame, &truth.road_strips[i])),
        PartKind::Room => spawn!(i => {
            let room = &truth.rooms[i];
            let difficulty = room.difficulty.map(|difficulty| difficulty as f32);
            let (name, contents) = (room.name.clone(), room.contents.into());
            (frame.place(&room.shape), Room { name, difficulty, lit: room.lit, contents })
        }),
        PartKind::Doorway => spawn!(i => {
            let doorway = &truth.doorways[i];
            let part = Doorway { open: doorway.open, rooms: doorway.rooms };
            (frame.place(&doorway.shape), part)
        }),
        PartKind::Obstacle => spawn!(i => {
            let obstacle = &truth.obstacles[i];
            (frame.place(&obstacle.shape), Obstacle { kind: obstacle.kind.into() })
        }),
        PartKind::Surface => spawn!(i => {
            let surface = &truth.surfaces[i];
            let (speed, odometry_noise) = (surface.speed as f32, surface.odometry_noise as f32);
            let part = Surface { kind: surface.kind.into(), speed, odometry_noise };
            (frame.place(&surface.shape), part)
        }),
        PartKind::Start => spawn!(i => (pose(&truth.start.unwrap_or_default()), Start)),
        PartKind::Goal => spawn!(i => (pose(&truth.goal.unwrap_or_default()), Goal)),
        PartKind::Victim => spawn!(i => (pose(&truth.victims[i]), Victim)),
        PartKind::Ground => spawn!(i => ground(frame, truth, plan.block, i as u32)),
    }
}

fn road(frame: Frame, strip: &envgen::world::RoadStrip) -> ((Transform, PartShape), RoadStrip) {
    let points: Vec<DVec2> = strip.centreline.iter().map(|point| point.pose.position).collect();
    let (transform, centreline) = frame.around(&points);
    let (width, lanes, closed) = (strip.width as f32, strip.lanes, strip.closed);
    let shape = PartShape::Strip { centreline, width, closed };
    ((transform, shape), RoadStrip { width, lanes, closed })
}

fn ground(
    frame: Frame,
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
}
