//! Computes the difficulty vector of an environment's world on request.

use std::sync::Arc;

use bevy::prelude::*;
#[cfg(feature = "serialize")]
use bevy::reflect::{ReflectDeserialize, ReflectSerialize};
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};
use envgen::World;
use envgen::calibration::{Calibration, Prediction};
use envgen::difficulty::{DifficultyError, DifficultyVector, Platform};

use crate::environment::GroundTruth;

/// A component that requests the difficulty vector of an environment's world: numbers that describe how hard
/// it is to map the world with a given robot and laser.
///
/// Add it to the entity of the [`Environment`](crate::Environment). A background task computes the vector,
/// which takes some tens of milliseconds for an indoor map. Then [`EnvironmentDifficulty`] or
/// [`DifficultyFailure`] is inserted on the entity, and [`DifficultyComputed`] is triggered on it and written
/// as a message. The vector is computed again when the world or this component changes. Removing this
/// component removes the results. Endless worlds have no difficulty.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_envgen::prelude::*;
///
/// fn report(computed: On<DifficultyComputed>, found: Query<&EnvironmentDifficulty>) {
///     let Ok(difficulty) = found.get(computed.entity) else { return };
///     println!("{} m of walls", difficulty.vector.walls.wall_length_m);
///     if let Some(prediction) = &difficulty.prediction {
///         println!("difficulty {:.1} of 10", prediction.dials.difficulty.value);
///     }
/// }
///
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, TransformPlugin, EnvgenPlugins::default()));
/// app.add_observer(report);
/// let map = IndoorSpec { width: 6, height: 6, ..default() };
/// app.world_mut().spawn((Environment::new(map, 1), ComputeDifficulty::default()));
/// app.update(); // or app.run()
/// ```
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(DifficultyTask)]
pub struct ComputeDifficulty {
    /// The robot and its laser.
    pub platform: PlatformValue,
}

impl ComputeDifficulty {
    /// Requests the difficulty for a given robot and its laser.
    pub fn new(platform: Platform) -> Self {
        ComputeDifficulty { platform: PlatformValue(platform) }
    }
}

/// A [`Platform`] (a robot and its laser) as a value of a component. Scenes serialize it as the platform
/// itself.
#[derive(Clone, Debug, Default, PartialEq, Deref, DerefMut, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(opaque)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct PlatformValue(pub Platform);

/// A component with the difficulty of an environment's world, on the entity of the environment; see
/// [`ComputeDifficulty`]. Scenes do not hold it, since it is computed again.
#[derive(Component, Clone, Debug, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct EnvironmentDifficulty {
    /// The difficulty vector.
    pub vector: DifficultyVector,
    /// The dials that the calibration predicts from the vector, if the kind of world is calibrated and the
    /// platform is the default one.
    pub prediction: Option<Prediction>,
}

/// A component with the reason why the world of an environment has no difficulty vector; see
/// [`ComputeDifficulty`]. It is on the entity of the environment until a vector is computed.
#[derive(Component, Clone, Debug, PartialEq, Deref)]
#[component(clone_behavior = Ignore)]
pub struct DifficultyFailure(pub DifficultyError);

/// An event that is triggered on an environment, and written as a message, when its [`EnvironmentDifficulty`]
/// or its [`DifficultyFailure`] is available.
#[derive(EntityEvent, Message, Clone, Debug)]
pub struct DifficultyComputed {
    /// The environment.
    pub entity: Entity,
}

type Outcome = Result<EnvironmentDifficulty, DifficultyError>;

/// The running computation.
#[derive(Component, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct DifficultyTask {
    running: Option<Task<Outcome>>,
    /// The request that is being computed, or was computed last.
    asked: Option<ComputeDifficulty>,
}

/// An environment and its request.
type Requested =
    (Entity, &'static ComputeDifficulty, Ref<'static, GroundTruth>, &'static mut DifficultyTask);

/// A filter for environments of which the request or the world has changed.
type Renewed = Or<(Changed<ComputeDifficulty>, Changed<GroundTruth>)>;

/// Starts a computation for each environment whose request or world has changed.
pub(crate) fn request(mut environments: Query<Requested, Renewed>, mut commands: Commands) {
    for (entity, request, truth, mut task) in &mut environments {
        // A request that is written with the same value needs no new computation.
        if task.asked.as_ref() == Some(request) && !truth.is_changed() {
            continue;
        }
        task.asked = Some(request.clone());
        commands.entity(entity).try_remove::<(EnvironmentDifficulty, DifficultyFailure)>();
        let (world, platform) = (Arc::clone(&truth.0), request.platform.0.clone());
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
        task.running = Some(pool.spawn(async move { compute(&world, &platform) }));
    }
}

fn compute(world: &World, platform: &Platform) -> Outcome {
    let vector = DifficultyVector::of(world, platform)?;
    let calibration = Calibration::of_world(world).filter(|_| *platform == Platform::default());
    let prediction = calibration.map(|calibration| calibration.predict(&vector));
    Ok(EnvironmentDifficulty { vector, prediction })
}

/// Inserts and reports the results of finished tasks.
pub(crate) fn collect(
    mut environments: Query<(Entity, &mut DifficultyTask)>,
    mut commands: Commands,
) {
    for (entity, mut task) in &mut environments {
        let task = task.bypass_change_detection();
        let Some(outcome) = task.running.as_mut().and_then(check_ready) else { continue };
        task.running = None;
        commands.queue(move |world: &mut bevy::ecs::world::World| report(world, entity, outcome));
    }
}

/// Inserts and reports a result, unless its request or its world has been removed since.
fn report(world: &mut bevy::ecs::world::World, entity: Entity, outcome: Outcome) {
    let Ok(mut root) = world.get_entity_mut(entity) else { return };
    // Where the request or the world was removed, the task has been reset.
    if root.get::<DifficultyTask>().is_none_or(|task| task.asked.is_none()) {
        return;
    }
    match outcome {
        Ok(difficulty) => root.insert(difficulty),
        Err(error) => root.insert(DifficultyFailure(error)),
    };
    if world.get_entity(entity).is_ok() {
        let computed = DifficultyComputed { entity };
        world.write_message(computed.clone());
        world.trigger(computed);
    }
}

/// Removes the results when the world is removed.
fn lose_world(
    removed: On<Remove, GroundTruth>,
    tasks: Query<&mut DifficultyTask>,
    commands: Commands,
) {
    clear(removed.entity, tasks, commands);
}

/// Removes the results when the request is removed.
fn lose_request(
    removed: On<Remove, ComputeDifficulty>,
    tasks: Query<&mut DifficultyTask>,
    commands: Commands,
) {
    clear(removed.entity, tasks, commands);
}

fn clear(entity: Entity, mut tasks: Query<&mut DifficultyTask>, mut commands: Commands) {
    if let Ok(mut task) = tasks.get_mut(entity) {
        *task = DifficultyTask::default();
        commands.entity(entity).try_remove::<(EnvironmentDifficulty, DifficultyFailure)>();
    }
}

pub(crate) fn register(app: &mut App) {
    app.register_type::<ComputeDifficulty>()
        .add_message::<DifficultyComputed>()
        .add_observer(lose_world)
        .add_observer(lose_request);
}
