//! The systems of [`EnvgenCorePlugin`](crate::EnvgenCorePlugin), which generate and spawn requested worlds.

use std::sync::Arc;
use std::time::Instant;

use bevy::prelude::*;
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, TaskPool};
use envgen::forest::EndlessForest;
use envgen::{GenerateError, Seed, WorldSpec};

use crate::diagnostics::{EnvgenDiagnosticsPlugin, measure};
use crate::environment::{
    EndlessTruth, Environment, EnvironmentError, EnvironmentExtent, EnvironmentFailed,
    EnvironmentFailure, EnvironmentReady, EnvironmentState, EnvironmentStats, GenerationMode,
    GroundTruth, RebuildEnvironment, SpawnedOrigin, WorldSource,
};
use crate::job::{Generated, GenerationJob, Job, Outcome, PendingEvents, Request, SpawnedTiles};
use crate::landmarks::EnvironmentLandmarks;
use crate::place::{check_transform, global_transform, propagate};
use crate::plan::{Plan, size};
use crate::spawn::{Tile, spawn_page};
use crate::streaming::{StreamAround, Streaming};

/// The largest number of parts that are spawned at once. Larger worlds must be streamed.
pub const MAX_PARTS: usize = 2_000_000;

/// The largest amount of work for which [`GenerationMode::Auto`] blocks. The unit is one part, cell or point,
/// each of which takes a fraction of a microsecond.
const IN_PLACE_WORK: f64 = 1e4;

/// An environment and its state.
type Requested = (
    Entity,
    Ref<'static, Environment>,
    Option<&'static StreamAround>,
    &'static mut GenerationJob,
    &'static mut EnvironmentState,
);

/// Starts a job for every environment that has changed.
pub(crate) fn request_worlds(
    mut environments: Query<Requested>,
    #[cfg(feature = "asset")] assets: Option<Res<Assets<crate::asset::WorldAsset>>>,
) {
    for (entity, environment, stream, mut slot, mut state) in &mut environments {
        // The tiles of an endless world are defined by its extent.
        let tile = stream.map(|stream| match environment.extent {
            EnvironmentExtent::Endless { .. } => 0.0,
            EnvironmentExtent::Finite => stream.tile,
        });
        let waits = matches!(slot.job, Job::Asset);
        // Sides are compared by bits, so that a side of NaN is rejected once and not in every frame.
        let bits = |tile: Option<f64>| tile.map(f64::to_bits);
        let same_tile = slot.asked.as_ref().is_some_and(|asked| bits(asked.tile) == bits(tile));
        if !(environment.is_changed() || slot.stale || waits || !same_tile) {
            continue;
        }
        let ask = Request { environment: (*environment).clone(), tile };
        let same = slot.asked.as_ref() == Some(&ask);
        if same && !slot.stale && !waits {
            continue;
        }
        if !same && matches!(slot.job, Job::Asset | Job::Task(_)) {
            log::warn!(
                "environment {entity}: another world is requested before the previous one is ready"
            );
        }
        slot.stale = false;
        slot.requests += 1;
        let spec = match &ask.environment.source {
            WorldSource::Spec(spec) => Some(WorldSpec::clone(spec)),
            WorldSource::World(_) => None,
            #[cfg(feature = "asset")]
            WorldSource::Asset(handle) => {
                let Some(assets) = &assets else {
                    slot.job = Job::Done(EnvironmentError::NoAssets.into());
                    slot.asked = Some(ask);
                    continue;
                };
                let Some(asset) = assets.get(handle) else {
                    slot.job = Job::Asset;
                    slot.asked = Some(ask);
                    state.set_if_neq(EnvironmentState::Waiting);
                    continue;
                };
                slot.spec = Some(asset.spec.clone());
                Some(asset.spec.clone())
            }
        };
        let work = match (&ask.environment.source, ask.environment.extent) {
            (_, EnvironmentExtent::Endless { .. }) => 0.0,
            (WorldSource::World(world), _) => size(world) as f64,
            _ => spec.as_ref().map_or(0.0, WorldSpec::work),
        };
        let in_place = match ask.environment.pace {
            GenerationMode::Auto => work <= IN_PLACE_WORK,
            GenerationMode::Blocking => true,
            GenerationMode::Async => false,
        };
        slot.asked = Some(ask.clone());
        if in_place {
            slot.job = Job::Done(make(&ask, spec));
        } else {
            state.set_if_neq(EnvironmentState::Generating);
            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
            slot.job = Job::Task(pool.spawn(async move { make(&ask, spec) }));
        }
    }
}

/// Generates a world and sorts its parts into tiles. No other step may take long.
fn make(ask: &Request, spec: Option<WorldSpec>) -> Outcome {
    let start = Instant::now();
    let result = try_make(ask, spec);
    Outcome { result, time: start.elapsed() }
}

fn try_make(ask: &Request, spec: Option<WorldSpec>) -> Result<Generated, EnvironmentError> {
    let Environment { source, seed, extent, origin, .. } = &ask.environment;
    if !origin.is_finite() {
        return Err(EnvironmentError::Origin(*origin));
    }
    let seed = Seed(*seed);
    match (extent, source, spec) {
        (EnvironmentExtent::Endless { .. }, WorldSource::World(_), _)
        | (EnvironmentExtent::Endless { .. }, _, None) => Err(EnvironmentError::Existing),
        (EnvironmentExtent::Endless { tile }, _, Some(spec)) => {
            let WorldSpec::Forest(forest) = &spec else {
                return Err(EnvironmentError::NotEndless(spec.kind()));
            };
            if ask.tile.is_none() {
                return Err(EnvironmentError::NoAnchor);
            }
            let forest = EndlessForest::new(forest, *tile, seed).map_err(GenerateError::from)?;
            Ok(Generated::Endless(Arc::new(forest)))
        }
        (EnvironmentExtent::Finite, _, Some(spec)) => {
            let world = spec.generate(seed)?.to_world();
            debug_assert_eq!(world.check(), Ok(()), "{spec:?}, seed {seed}");
            Ok(Generated::Finite(Arc::new(plan(Arc::new(world), ask.tile)?)))
        }
        (EnvironmentExtent::Finite, WorldSource::World(world), None) => {
            world.check()?;
            Ok(Generated::Finite(Arc::new(plan(Arc::clone(&world.0), ask.tile)?)))
        }
        #[cfg(feature = "asset")]
        (EnvironmentExtent::Finite, WorldSource::Asset(_), None) => Err(EnvironmentError::NoAssets),
        (EnvironmentExtent::Finite, WorldSource::Spec(_), None) => {
            unreachable!("a spec is its own")
        }
    }
}

fn plan(world: Arc<envgen::World>, tile: Option<f64>) -> Result<Plan, EnvironmentError> {
    if let Some(tile) = tile {
        crate::streaming::check_tile(tile)?;
    }
    let plan = Plan::new(world, tile);
    if tile.is_none() && plan.parts > MAX_PARTS {
        return Err(EnvironmentError::TooMany { parts: plan.parts, limit: MAX_PARTS });
    }
    Ok(plan)
}

/// Collects the results of finished tasks.
pub(crate) fn poll_tasks(mut slots: Query<&mut GenerationJob>) {
    for mut slot in &mut slots {
        if let Job::Task(task) = &mut slot.bypass_change_detection().job
            && let Some(outcome) = check_ready(task)
        {
            slot.job = Job::Done(outcome);
        }
    }
}

/// Replaces the previous worlds by the generated ones.
pub(crate) fn spawn_worlds(
    world: &mut World,
    slots: &mut QueryState<(Entity, &mut GenerationJob)>,
) {
    let mut done: Vec<(Entity, Outcome)> = Vec::new();
    for (entity, mut slot) in slots.iter_mut(world) {
        if matches!(slot.job, Job::Done(_))
            && let Job::Done(outcome) = std::mem::take(&mut slot.job)
        {
            done.push((entity, outcome));
        }
    }
    for (entity, Outcome { result, time }) in done {
        let global = global_transform(world, entity);
        let placed = result.and_then(|made| {
            measure(world, &EnvgenDiagnosticsPlugin::GENERATION_TIME, 1e3 * time.as_secs_f64());
            check_transform(&global)?;
            Ok(made)
        });
        match placed {
            Ok(made) => spawn_world(world, entity, &global, &made),
            Err(error) => {
                if matches!(error, EnvironmentError::Transform { .. }) {
                    suspend(world, entity);
                } else if let Some(mut tiles) = world.get_mut::<SpawnedTiles>(entity) {
                    // Another transform would not help.
                    tiles.suspended = false;
                }
                world.get_resource_or_init::<PendingEvents>().push(entity, Err(error));
            }
        }
    }
}

/// Spawns a generated world, or prepares it for streaming.
fn spawn_world(world: &mut World, entity: Entity, global: &GlobalTransform, made: &Generated) {
    clear(world, entity);
    propagate(world, entity, *global);
    crate::scenario::remove(world, entity);
    let Some(slot) = world.get::<GenerationJob>(entity) else { return };
    let Some(ask) = &slot.asked else { return };
    let (layout, tile, request) = (ask.environment.layout(), ask.tile, slot.requests);
    if let Ok(mut root) = world.get_entity_mut(entity) {
        root.remove::<(GroundTruth, EndlessTruth, EnvironmentStats, Streaming)>();
    }
    insert(world, entity, SpawnedOrigin(layout.origin));
    match made {
        Generated::Finite(plan) => {
            let stats = EnvironmentStats { parts: Some(plan.parts), solids: Some(plan.solids) };
            let landmarks = EnvironmentLandmarks::new(&plan.world, layout.origin, global);
            insert(world, entity, (GroundTruth(Arc::clone(&plan.world)), stats, landmarks));
        }
        Generated::Endless(forest) => {
            let stats = EnvironmentStats { parts: None, solids: None };
            let landmarks = EnvironmentLandmarks::default();
            insert(world, entity, (EndlessTruth(Arc::clone(forest)), stats, landmarks));
        }
    }
    let mut spawned_tiles = SpawnedTiles::default();
    if tile.is_some() {
        let streaming = Streaming::new(made.clone(), layout, request);
        insert(world, entity, (streaming, spawned_tiles, EnvironmentState::Streaming));
        return;
    }
    if let Generated::Finite(plan) = made {
        for (&key, tile) in &plan.tiles {
            let pages = tile.parts.len().div_ceil(plan.page);
            let spawned: Vec<Entity> = (0..pages)
                .filter_map(|page| spawn_page(world, entity, layout, plan, key, page))
                .collect();
            spawned_tiles.tiles.insert(key, spawned);
        }
    }
    insert(world, entity, spawned_tiles);
    // For an entity without an environment, nothing is reported.
    world.get_resource_or_init::<PendingEvents>().push(entity, Ok(()));
}

/// Inserts components on an environment, unless an observer of others has despawned the entity or removed its
/// environment. Returns whether the environment exists afterwards.
fn insert(world: &mut World, entity: Entity, components: impl Bundle) -> bool {
    if let Ok(mut root) = world.get_entity_mut(entity)
        && root.contains::<Environment>()
    {
        root.insert(components);
    }
    world.get::<Environment>(entity).is_some()
}

/// Despawns all tiles below an environment, and nothing else. This includes tiles that were spawned from a
/// scene, or cloned, together with the environment.
pub(crate) fn clear(world: &mut World, entity: Entity) {
    let mut tiles: Vec<Entity> = match world.get_mut::<SpawnedTiles>(entity) {
        Some(mut spawned_tiles) => {
            std::mem::take(&mut spawned_tiles.tiles).into_values().flatten().collect()
        }
        None => Vec::new(),
    };
    let below = world.get::<Children>(entity).into_iter().flatten();
    tiles.extend(below.filter(|&&child| world.get::<Tile>(child).is_some()));
    for tile in tiles {
        if let Ok(tile) = world.get_entity_mut(tile) {
            tile.despawn();
        }
    }
}

/// Despawns the world of an environment until the transform of the environment is valid again.
fn suspend(world: &mut World, entity: Entity) {
    clear(world, entity);
    crate::scenario::remove(world, entity);
    if let Ok(mut root) = world.get_entity_mut(entity) {
        root.remove::<(
            EndlessTruth,
            EnvironmentLandmarks,
            EnvironmentStats,
            GroundTruth,
            SpawnedOrigin,
            Streaming,
        )>();
    }
    insert(world, entity, SpawnedTiles { suspended: true, ..default() });
}

/// Suspends environments whose transform has become invalid for a flat world, and requests suspended worlds
/// again when their transform has become valid.
pub(crate) fn watch_transforms(
    mut environments: Query<
        (Entity, &GlobalTransform, &mut GenerationJob, &mut EnvironmentState, &SpawnedTiles),
        Changed<GlobalTransform>,
    >,
    mut notices: ResMut<PendingEvents>,
    mut commands: Commands,
) {
    for (entity, transform, mut slot, mut state, spawned_tiles) in &mut environments {
        match (check_transform(transform), spawned_tiles.suspended) {
            (Err(error), false) => {
                notices.push(entity, Err(error));
                commands.queue(move |world: &mut World| suspend(world, entity));
            }
            // Only once, since a transform that changes in every frame would otherwise start a task in each.
            (Ok(()), true) if matches!(slot.job, Job::Idle) && !slot.stale => {
                slot.stale = true;
                *state = EnvironmentState::Waiting;
            }
            _ => {}
        }
    }
}

/// Reports the environments that have become ready or have failed.
pub(crate) fn notify(world: &mut World) {
    let notices = std::mem::take(&mut world.get_resource_or_init::<PendingEvents>().0);
    for (entity, notice) in notices {
        let Ok(mut root) = world.get_entity_mut(entity) else { continue };
        if !root.contains::<Environment>() {
            continue;
        }
        match notice {
            Ok(()) => {
                root.remove::<EnvironmentFailure>();
                if insert(world, entity, EnvironmentState::Ready) {
                    move_to_place(world, entity);
                    let ready = EnvironmentReady { entity };
                    world.write_message(ready.clone());
                    world.trigger(ready);
                }
            }
            Err(error) => {
                let failure = (EnvironmentState::Failed, EnvironmentFailure(error.clone()));
                if insert(world, entity, failure) {
                    log::warn!("environment {entity}: {error}");
                    let failed = EnvironmentFailed { entity, error };
                    world.write_message(failed.clone());
                    world.trigger(failed);
                }
            }
        }
        world.flush();
    }
}

/// Propagates the transform of an environment that has moved since Bevy propagated transforms.
fn move_to_place(world: &mut World, entity: Entity) {
    let global = global_transform(world, entity);
    if world.get::<GlobalTransform>(entity) == Some(&global) {
        return;
    }
    propagate(world, entity, global);
    if let Some(mut landmarks) = world.get_mut::<EnvironmentLandmarks>(entity) {
        landmarks.follow(&global);
    }
}

/// Waits for the running tasks of an environment, and returns whether there were any.
#[cfg(feature = "testing")]
pub(crate) fn finish_tasks(world: &mut World, environment: Entity) -> bool {
    let generated =
        world.get_mut::<GenerationJob>(environment).is_some_and(|mut slot| slot.finish());
    let drawn =
        world.get_mut::<Streaming>(environment).is_some_and(|mut streaming| streaming.finish());
    generated || drawn
}

/// Removes everything that belongs to a removed [`Environment`].
pub(crate) fn clean_up(removed: On<Remove, Environment>, mut commands: Commands) {
    let entity = removed.entity;
    commands.queue(move |world: &mut World| {
        // Inserting another `Environment` must not remove anything here, and despawning removes the children
        // anyway.
        if world.get_entity(entity).is_ok_and(|root| !root.contains::<Environment>()) {
            clear(world, entity);
            crate::scenario::remove(world, entity);
            let Ok(mut root) = world.get_entity_mut(entity) else { return };
            root.remove::<(
                EndlessTruth,
                EnvironmentFailure,
                EnvironmentLandmarks,
                EnvironmentState,
                EnvironmentStats,
                GroundTruth,
                GenerationJob,
                SpawnedOrigin,
                SpawnedTiles,
                Streaming,
            )>();
        }
    });
}

/// Marks an environment to be rebuilt.
pub(crate) fn rebuild(asked: On<RebuildEnvironment>, mut slots: Query<&mut GenerationJob>) {
    match slots.get_mut(asked.entity) {
        Ok(mut slot) => slot.stale = true,
        Err(_) => log::warn!("{} cannot be rebuilt: it has no `Environment`", asked.entity),
    }
}
