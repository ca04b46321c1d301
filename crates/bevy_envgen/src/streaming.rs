//! Streaming: spawns and despawns the tiles of a world around an anchor.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};
use envgen::forest::EndlessForest;
use envgen::glam::DVec2;
use envgen::world::Tree;

use crate::diagnostics::{EnvgenDiagnosticsPlugin, measure};
use crate::environment::{
    Environment, EnvironmentError, EnvironmentState, GenerationMode, TileLayout,
};
use crate::job::{Generated, GenerationJob, PendingEvents, SpawnedTiles};
use crate::place::global_transform;
use crate::plan::{Plan, TileKey, distance};
use crate::spawn::{TileSolids, spawn_page, spawn_trees};

/// The largest number of trees of one tile entity of an endless forest.
const PAGE: usize = 128;

/// The largest number of tiles across the window of streaming.
const MAX_TILES_ACROSS: f64 = 512.0;

/// The largest number of tiles of an endless forest that are generated at the same time in the background.
const MAX_TASKS: usize = 16;

/// The largest expected number of trees in a tile of an endless forest for which [`GenerationMode::Auto`]
/// blocks.
const IN_PLACE_TREES: f64 = 500.0;

/// A component that limits the spawned tiles to those with a part within `radius` of an anchor.
///
/// Add it to the entity of an [`Environment`]. Once everything within the radius is spawned, which may take
/// several frames because of the [`StreamingBudget`], the spawned parts depend only on the current position
/// of the anchor, not on its earlier positions. Adding or removing the component, or changing `tile`,
/// rebuilds the world. In scenes and clones, the anchor is the spawned or cloned entity, if the anchor is
/// part of them.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// fn stream(mut commands: Commands) {
///     let robot = commands.spawn(Transform::default()).id();
///     let forest = ForestSpec { width: 200.0, height: 200.0, ..default() };
///     let around = StreamAround::new(robot, 40.0).with_tile(20.0);
///     commands.spawn((Environment::new(forest, 7), around));
/// }
/// # let mut app = bevy_envgen::testing::test_app();
/// # bevy::ecs::system::RunSystemOnce::run_system_once(app.world_mut(), stream).unwrap();
/// # bevy_envgen::testing::step(&mut app, 3);
/// # assert!(app.world_mut().query::<&PartId>().iter(app.world()).count() > 20);
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct StreamAround {
    /// The entity around which the world is spawned, such as a robot or a camera.
    #[entities]
    pub anchor: Entity,
    /// The distance in metres from the anchor within which everything is spawned.
    pub radius: f64,
    /// The side of a tile in metres. It is ignored for an endless world, which defines its own.
    pub tile: f64,
}

impl StreamAround {
    /// Streams everything within `radius` metres of the anchor, in tiles of a quarter of that.
    pub fn new(anchor: Entity, radius: f64) -> Self {
        StreamAround { anchor, radius, tile: 0.25 * radius }
    }

    /// Sets the side of a tile in metres.
    pub fn with_tile(self, tile: f64) -> Self {
        StreamAround { tile, ..self }
    }
}

/// A resource that limits the work of streaming per frame, for all worlds together.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub enum StreamingBudget {
    /// A time limit. At least one step is taken in every frame, which spawns 128 parts or despawns a tile, so
    /// that streaming completes with any budget.
    Time(Duration),
    /// A limit on the number of spawned and despawned parts, rounded up to whole steps. With
    /// [`GenerationMode::Blocking`], it gives the same result in every run, for simulations that must be
    /// repeatable frame by frame. With other modes, worlds and tiles may be generated in the background, and
    /// the frame in which they are complete varies.
    Parts(usize),
}

impl Default for StreamingBudget {
    fn default() -> Self {
        StreamingBudget::Time(Duration::from_millis(2))
    }
}

/// A resource that reports what streaming did in the last frame. The time is also a diagnostic:
/// [`EnvgenDiagnosticsPlugin::STREAMING_TIME`].
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct StreamingReport {
    /// The number of tile entities that were spawned.
    pub spawned: usize,
    /// The number of tile entities that were despawned.
    pub despawned: usize,
    /// The number of tiles that still have to be spawned or despawned.
    pub waiting: usize,
    /// The time that streaming took.
    pub time: Duration,
}

/// A component with the state of a streamed world.
#[derive(Component)]
pub(crate) struct Streaming {
    made: Generated,
    layout: TileLayout,
    /// The number of the request of this world.
    request: u64,
    /// The tiles that are completely spawned.
    complete: BTreeSet<TileKey>,
    /// The tiles of an endless forest that are generated or being generated, but not completely spawned.
    drawn: Vec<(TileKey, Drawing)>,
    settled: bool,
    /// Whether the tile nearest to the anchor has been missing since the world was settled.
    lost: bool,
    /// The bits of the last rejected radius.
    refused: Option<u64>,
    /// Whether a missing anchor has been reported.
    warned: bool,
}

enum Drawing {
    Task(Task<Vec<Tree>>),
    Trees(Arc<Vec<Tree>>),
}

impl Streaming {
    pub(crate) fn new(made: Generated, layout: TileLayout, request: u64) -> Self {
        let (complete, drawn) = (BTreeSet::new(), Vec::new());
        let (settled, lost, refused, warned) = (false, false, None, false);
        Streaming { made, layout, request, complete, drawn, settled, lost, refused, warned }
    }

    /// Waits for the running tasks, and returns whether there were any.
    #[cfg(feature = "testing")]
    pub(crate) fn finish(&mut self) -> bool {
        let mut had = false;
        for (_, drawing) in &mut self.drawn {
            if let Drawing::Task(task) = drawing {
                *drawing = Drawing::Trees(Arc::new(bevy::tasks::block_on(task)));
                had = true;
            }
        }
        had
    }
}

/// The remaining budget of a frame.
struct Allowance {
    budget: StreamingBudget,
    start: Instant,
    /// The longest step so far in this frame.
    longest: Duration,
    parts: usize,
    steps: usize,
}

impl Allowance {
    /// Returns whether the budget allows another step.
    fn remains(&self) -> bool {
        self.steps == 0
            || match self.budget {
                StreamingBudget::Time(budget) => self.start.elapsed() + self.longest < budget,
                StreamingBudget::Parts(budget) => self.parts < budget,
            }
    }

    /// Runs a step that spawns or despawns `parts` parts.
    fn step<T>(&mut self, parts: usize, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.longest = self.longest.max(start.elapsed());
        self.parts += parts;
        self.steps += 1;
        result
    }
}

pub(crate) fn check_tile(tile: f64) -> Result<(), EnvironmentError> {
    if tile >= 0.01 && tile.is_finite() {
        return Ok(());
    }
    let allowed = "a finite number of metres, at least 0.01".to_owned();
    Err(EnvironmentError::Stream { field: "tile", value: tile, allowed })
}

fn check_radius(radius: f64, tile: f64) -> Result<(), EnvironmentError> {
    let most = 0.5 * MAX_TILES_ACROSS * tile;
    if radius >= 0.0 && radius <= most {
        return Ok(());
    }
    let allowed = format!("from 0 m to {most} m in tiles of {tile} m");
    Err(EnvironmentError::Stream { field: "radius", value: radius, allowed })
}

/// Spawns and despawns tiles of all streamed worlds within the budget. A different world is the first in each
/// frame, so that no world waits forever for one that always has something to do.
pub(crate) fn stream_tiles(
    world: &mut World,
    streamed: &mut QueryState<Entity, With<Streaming>>,
    mut turn: Local<usize>,
) {
    let mut roots: Vec<Entity> = streamed.iter(world).collect();
    *turn = (*turn + 1) % roots.len().max(1);
    roots.rotate_left(*turn);
    let mut report = StreamingReport::default();
    let start = Instant::now();
    if !roots.is_empty() {
        let budget = world.get_resource::<StreamingBudget>().copied().unwrap_or_default();
        let (longest, parts, steps) = (Duration::ZERO, 0, 0);
        let mut allowance = Allowance { budget, start, longest, parts, steps };
        for root in roots {
            stream(world, root, &mut allowance, &mut report);
        }
        report.time = start.elapsed();
        let time = 1e3 * report.time.as_secs_f64();
        measure(world, &EnvgenDiagnosticsPlugin::STREAMING_TIME, time);
    }
    if let Some(mut known) = world.get_resource_mut::<StreamingReport>() {
        known.set_if_neq(report);
    }
}

fn stream(
    world: &mut World,
    root: Entity,
    allowance: &mut Allowance,
    report: &mut StreamingReport,
) {
    let Some(stream) = world.get::<StreamAround>(root).copied() else { return };
    let pace = world.get::<Environment>(root).map(|environment| environment.pace);
    let (Some(at), Some(pace)) = (anchor(world, root, stream.anchor), pace) else {
        if let Some(mut streaming) = world.get_mut::<Streaming>(root)
            && !std::mem::replace(&mut streaming.warned, true)
        {
            log::warn!("environment {root}: its anchor {} has no finite position", stream.anchor);
        }
        return;
    };
    // Both components are taken out, so that the ECS can be borrowed for spawning, and put back below.
    let Ok(mut entity) = world.get_entity_mut(root) else { return };
    let Some(spawned_tiles) = entity.get_mut::<SpawnedTiles>().map(|mut s| std::mem::take(&mut *s))
    else {
        return;
    };
    let Some(mut known) = entity.get_mut::<Streaming>() else { return };
    let placeholder = Streaming::new(known.made.clone(), known.layout, known.request);
    let mut streaming = std::mem::replace(&mut *known, placeholder);
    streaming.warned = false;
    let mut streamer =
        TileStreamer { world, root, pace, spawned_tiles, streaming, allowance, report };
    streamer.follow(stream, at);
    let TileStreamer { world, spawned_tiles, streaming, .. } = streamer;
    if let Ok(mut root) = world.get_entity_mut(root) {
        if let Some(mut known) = root.get_mut::<SpawnedTiles>() {
            *known = spawned_tiles;
        }
        if let Some(mut known) = root.get_mut::<Streaming>() {
            *known = streaming;
        }
    }
}

/// Returns the position of the anchor in the frame of the environment.
fn anchor(world: &World, root: Entity, anchor: Entity) -> Option<DVec2> {
    world.get::<Transform>(anchor)?;
    let into_frame = global_transform(world, root).affine().inverse();
    let at = into_frame.transform_point3(global_transform(world, anchor).translation()).truncate();
    at.is_finite().then(|| at.as_dvec2())
}

/// Returns the tiles of an endless forest within `radius` of a point, each with its distance.
fn endless_near(forest: &EndlessForest, at: DVec2, radius: f64) -> Vec<(f64, TileKey)> {
    let cell = |p: DVec2| {
        let cell = (p / forest.tile_side()).floor();
        [cell.x as i32, cell.y as i32]
    };
    let ([i0, j0], [i1, j1]) = (cell(at - radius), cell(at + radius));
    (i0..=i1)
        .flat_map(|i| (j0..=j1).map(move |j| [i, j]))
        .map(|at| TileKey { level: 0, at })
        .map(|key| (distance(forest.tile_rect(key.at[0], key.at[1]), at), key))
        .filter(|&(distance, _)| distance <= radius)
        .collect()
}

/// The tiles of one environment while they are updated to the position of its anchor.
struct TileStreamer<'a> {
    world: &'a mut World,
    root: Entity,
    pace: GenerationMode,
    spawned_tiles: SpawnedTiles,
    streaming: Streaming,
    allowance: &'a mut Allowance,
    report: &'a mut StreamingReport,
}

impl TileStreamer<'_> {
    /// Spawns and despawns tiles to reach those that are wanted around a point of the world, and records
    /// events.
    fn follow(&mut self, stream: StreamAround, at: DVec2) {
        let at = at + self.streaming.layout.origin;
        let wanted = match &self.streaming.made {
            // If another side was requested since, the tiles still have that of the spawned world.
            Generated::Finite(plan) => {
                check_radius(stream.radius, plan.side).map(|()| plan.near(at, stream.radius))
            }
            Generated::Endless(forest) => check_radius(stream.radius, forest.tile_side())
                .map(|()| endless_near(forest, at, stream.radius)),
        };
        match wanted {
            Ok(mut wanted) => {
                let is_current = self.is_current();
                if self.streaming.refused.take().is_some() && is_current {
                    self.set_state(EnvironmentState::Streaming);
                }
                wanted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let waiting = self.settle(&wanted);
                self.report.waiting += waiting;
                // A world that is about to be replaced by another request is not reported.
                if is_current {
                    self.report(waiting, &wanted);
                }
            }
            Err(error) => {
                // An error is reported once per radius, not in every frame.
                let radius = stream.radius.to_bits();
                if self.streaming.refused.replace(radius) != Some(radius) {
                    (self.streaming.settled, self.streaming.lost) = (false, false);
                    self.world.get_resource_or_init::<PendingEvents>().push(self.root, Err(error));
                }
            }
        }
    }

    /// Updates the state of the environment, and reports a world that is settled for the first time.
    fn report(&mut self, waiting: usize, wanted: &[(f64, TileKey)]) {
        let Streaming { settled, lost, complete, .. } = &mut self.streaming;
        if waiting == 0 && !std::mem::replace(settled, true) {
            self.world.get_resource_or_init::<PendingEvents>().push(self.root, Ok(()));
        }
        let is_missing = wanted.first().is_some_and(|(_, key)| !complete.contains(key));
        if *settled && std::mem::replace(lost, is_missing) != is_missing {
            self.set_state(if is_missing {
                EnvironmentState::Streaming
            } else {
                EnvironmentState::Ready
            });
        }
    }

    /// Sets the state of the environment, if it still exists.
    fn set_state(&mut self, state: EnvironmentState) {
        if let Ok(mut root) = self.world.get_entity_mut(self.root) {
            root.insert(state);
        }
    }

    /// Returns whether the world is that of the last request.
    fn is_current(&self) -> bool {
        let job = self.world.get::<GenerationJob>(self.root);
        job.is_some_and(|slot| slot.is_settled(self.streaming.request))
    }

    /// Runs steps towards the wanted tiles, the nearest first. Returns the number of tiles that still have to
    /// be spawned or despawned.
    fn settle(&mut self, wanted: &[(f64, TileKey)]) -> usize {
        let mut keys: Vec<TileKey> = wanted.iter().map(|(_, key)| *key).collect();
        keys.sort_unstable();
        let is_wanted = |key: &TileKey| keys.binary_search(key).is_ok();
        self.streaming.drawn.retain(|(key, _)| is_wanted(key));

        // Tiles that are left behind are despawned first if they are many. Otherwise spawning would use the
        // whole budget when the anchor moves fast.
        let left: Vec<TileKey> =
            self.spawned_tiles.tiles.keys().filter(|key| !is_wanted(key)).copied().collect();
        let many = left.len().saturating_sub(wanted.len() / 4);
        for &key in left.iter().take(many) {
            if !self.remove(key) {
                break;
            }
        }

        let mut waiting = 0;
        for (_, key) in wanted {
            if self.streaming.complete.contains(key) {
                continue;
            }
            if self.allowance.remains() && self.complete(*key) {
                self.streaming.complete.insert(*key);
            } else {
                waiting += 1;
            }
        }

        for key in left {
            waiting += usize::from(!self.remove(key));
        }
        waiting
    }

    /// Spawns pages of one tile within the budget. Returns true if the tile is complete.
    fn complete(&mut self, key: TileKey) -> bool {
        let TileStreamer { world, root, pace, spawned_tiles, streaming, allowance, report } = self;
        let (root, layout) = (*root, streaming.layout);
        match &streaming.made {
            Generated::Finite(plan) => {
                let pages = pages(plan, key);
                let entities = spawned_tiles.tiles.entry(key).or_default();
                while entities.len() < pages {
                    if !allowance.remains() {
                        return false;
                    }
                    let page = entities.len();
                    let spawn = || spawn_page(world, root, layout, plan, key, page);
                    let Some(tile) = allowance.step(plan.page, spawn) else { return false };
                    entities.push(tile);
                    report.spawned += 1;
                }
                true
            }
            Generated::Endless(forest) => {
                let forest = Arc::clone(forest);
                let Some(trees) = draw(&mut streaming.drawn, &forest, key, *pace, allowance) else {
                    return false;
                };
                let entities = spawned_tiles.tiles.entry(key).or_default();
                for (page, trees) in trees.chunks(PAGE).enumerate().skip(entities.len()) {
                    if !allowance.remains() {
                        return false;
                    }
                    let pages = (page * PAGE, trees);
                    let spawn = || spawn_trees(world, root, layout, key, pages, page);
                    let Some(tile) = allowance.step(trees.len(), spawn) else { return false };
                    entities.push(tile);
                    report.spawned += 1;
                }
                streaming.drawn.retain(|(drawn, _)| *drawn != key);
                true
            }
        }
    }

    /// Despawns the entities of one tile within the budget. Returns true if none is left.
    fn remove(&mut self, key: TileKey) -> bool {
        let TileStreamer { world, spawned_tiles, streaming, allowance, report, .. } = self;
        let Some(entities) = spawned_tiles.tiles.get_mut(&key) else { return true };
        if allowance.remains() {
            streaming.complete.remove(&key);
        }
        while allowance.remains()
            && let Some(tile) = entities.pop()
        {
            let parts = world.get::<Children>(tile).map_or(0, |children| children.len())
                + world.get::<TileSolids>(tile).map_or(0, |solids| solids.len());
            allowance.step(parts, || {
                if let Ok(tile) = world.get_entity_mut(tile) {
                    tile.despawn();
                }
            });
            report.despawned += 1;
        }
        let gone = entities.is_empty();
        if gone {
            spawned_tiles.tiles.remove(&key);
            // A tile without trees is removed before the first step.
            streaming.complete.remove(&key);
        }
        gone
    }
}

fn pages(plan: &Plan, key: TileKey) -> usize {
    plan.tiles.get(&key).map_or(0, |tile| tile.parts.len().div_ceil(plan.page))
}

/// Returns the trees of a tile of an endless forest, once they are generated.
fn draw(
    drawn: &mut Vec<(TileKey, Drawing)>,
    forest: &Arc<EndlessForest>,
    key: TileKey,
    pace: GenerationMode,
    allowance: &mut Allowance,
) -> Option<Arc<Vec<Tree>>> {
    let [i, j] = key.at;
    let Some(place) = drawn.iter().position(|(drawn, _)| *drawn == key) else {
        let in_place = match pace {
            GenerationMode::Auto => forest.expected_trees() <= IN_PLACE_TREES,
            GenerationMode::Blocking => true,
            GenerationMode::Async => false,
        };
        if in_place {
            let trees = Arc::new(allowance.step(0, || forest.tile(i, j)));
            drawn.push((key, Drawing::Trees(Arc::clone(&trees))));
            return Some(trees);
        }
        if drawn.iter().filter(|(_, drawing)| matches!(drawing, Drawing::Task(_))).count()
            < MAX_TASKS
        {
            let forest = Arc::clone(forest);
            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
            let task = pool.spawn(async move { forest.tile(i, j) });
            drawn.push((key, Drawing::Task(task)));
        }
        return None;
    };
    match &mut drawn[place].1 {
        Drawing::Trees(trees) => Some(Arc::clone(trees)),
        Drawing::Task(task) => {
            let trees = Arc::new(check_ready(task)?);
            drawn[place].1 = Drawing::Trees(Arc::clone(&trees));
            Some(trees)
        }
    }
}

#[cfg(test)]
mod tests {
    use envgen::forest::ForestSpec;

    use super::*;
    use crate::EnvgenCorePlugin;

    #[test]
    fn tiles_without_trees_are_forgotten() {
        let mut app = App::new();
        app.add_plugins(EnvgenCorePlugin::default());
        // The budget allows only one step per frame, so tiles are left behind.
        app.insert_resource(StreamingBudget::Parts(0));
        let anchor = app.world_mut().spawn(Transform::default()).id();
        let forest = ForestSpec { intensity: 0.001, radius: 0.3, ..default() };
        let environment = Environment::new(forest, 7).endless(10.0);
        let environment = environment.with_pace(GenerationMode::Blocking);
        let around = StreamAround::new(anchor, 30.0);
        let root = app.world_mut().spawn((environment, around, Transform::default())).id();
        for frame in 0..600 {
            // The anchor jumps once all tiles around it are complete.
            let at = Vec3::X * (frame / 200) as f32 * 100.0;
            app.world_mut().get_mut::<Transform>(anchor).unwrap().translation = at;
            app.update();
        }
        let root = app.world().entity(root);
        let (streaming, spawned) =
            (root.get::<Streaming>().unwrap(), root.get::<SpawnedTiles>().unwrap());
        assert!(spawned.tiles.values().any(|tile| tile.is_empty()));
        let complete: Vec<_> = streaming.complete.iter().collect();
        assert_eq!(complete, spawned.tiles.keys().collect::<Vec<_>>());
    }
}
