//! Helpers for tests of apps that use this crate: an app whose time is counted in steps, and what
//! stands in it.
//!
//! ```
//! use bevy_envgen::prelude::*;
//! use bevy_envgen::testing::{parts, spawn_ready, test_app};
//!
//! let mut app = test_app();
//! let spec = envgen::hallway::HallwaySpec::default();
//! let hallway = spawn_ready(&mut app, Environment::new(spec, 7))?;
//! assert!(parts(&app, hallway).iter().any(|part| part.id.kind == PartKind::Wall));
//! # Ok::<(), bevy_envgen::EnvironmentError>(())
//! ```

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use envgen::world::Digest;

use crate::environment::{
    Environment, EnvironmentError, EnvironmentFailed, EnvironmentState, GroundTruth,
};
use crate::{EnvgenPlugins, PartId, PartShape, StandingPart, TileSolids};

/// Fixed steps a second of [`test_app`].
pub const STEPS_A_SECOND: f64 = 64.0;

/// Frames that [`wait_until_ready`] waits, at most, of a millisecond each by the clock.
const MOST_FRAMES: usize = 60_000;

/// The last failure of each environment, for [`wait_until_ready`].
#[derive(Component, Clone)]
struct LastFailure(EnvironmentError);

/// A headless app with every plugin of this crate and those that they need, in which a frame is
/// exactly one fixed step of 1/64 s. It is finished and has had its first, empty frame.
pub fn test_app() -> App {
    test_app_with(EnvgenPlugins::default())
}

/// The same with assets from a folder of one's own; files that change are loaded again with the
/// feature `file_watcher`.
#[cfg(feature = "asset")]
pub fn test_app_in(folder: &std::path::Path) -> App {
    let file_path = folder.to_string_lossy().into_owned();
    finished(AssetPlugin { file_path, ..default() }, EnvgenPlugins::default())
}

/// The same with plugins of one's own choice and settings.
pub fn test_app_with<M>(plugins: impl bevy::app::Plugins<M>) -> App {
    #[cfg(feature = "asset")]
    let assets = AssetPlugin::default();
    #[cfg(not(feature = "asset"))]
    let assets = |_: &mut App| {};
    finished(assets, plugins)
}

fn finished<A, M>(assets: impl bevy::app::Plugins<A>, plugins: impl bevy::app::Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    app.add_plugins(assets);
    #[cfg(feature = "physics")]
    app.add_plugins(crate::physics::TopDownPhysicsPlugin::new(STEPS_A_SECOND));
    app.add_plugins(plugins);
    let step = Duration::from_secs_f64(1.0 / STEPS_A_SECOND);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
    app.insert_resource(Time::<Fixed>::from_duration(step));
    app.add_observer(|failed: On<EnvironmentFailed>, mut commands: Commands| {
        let failure = LastFailure(failed.error.clone());
        if let Ok(mut root) = commands.get_entity(failed.entity) {
            root.try_insert(failure);
        }
    });
    app.finish();
    app.cleanup();
    // Time starts to run with the second frame.
    app.update();
    app
}

/// Runs so many frames: in a [`test_app`] as many fixed steps.
pub fn step(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

/// Runs frames until an environment is ready or has failed.
///
/// # Errors
/// Why it failed.
///
/// # Panics
/// When nothing comes of it in a minute, or the entity has no [`Environment`].
pub fn wait_until_ready(app: &mut App, environment: Entity) -> Result<(), EnvironmentError> {
    app.world_mut().entity_mut(environment).remove::<LastFailure>();
    for _ in 0..MOST_FRAMES {
        app.update();
        let root = app.world().entity(environment);
        match root.get::<EnvironmentState>() {
            Some(EnvironmentState::Ready) => return Ok(()),
            Some(EnvironmentState::Failed) => {
                if let Some(LastFailure(error)) = root.get() {
                    return Err(error.clone());
                }
            }
            // Other threads are at work.
            Some(_) => std::thread::sleep(Duration::from_millis(1)),
            None => panic!("{environment} has no `Environment`"),
        }
    }
    panic!("{environment} was neither ready nor failed after {MOST_FRAMES} frames");
}

/// Spawns an environment and waits until it is ready.
///
/// # Errors
/// Why it failed.
pub fn spawn_ready(app: &mut App, environment: Environment) -> Result<Entity, EnvironmentError> {
    let environment = app.world_mut().spawn(environment).id();
    wait_until_ready(app, environment).map(|()| environment)
}

/// The parts below an environment, entities and data, in the order of their ids.
pub fn parts(app: &App, environment: Entity) -> Vec<StandingPart> {
    let mut parts = Vec::new();
    let mut below = vec![environment];
    while let Some(entity) = below.pop() {
        let entity = app.world().entity(entity);
        if let (Some(id), Some(transform), Some(shape)) =
            (entity.get::<PartId>(), entity.get::<Transform>(), entity.get::<PartShape>())
        {
            parts.push(StandingPart { id: *id, transform: *transform, shape: shape.clone() });
        }
        parts
            .extend(entity.get::<TileSolids>().into_iter().flat_map(|data| data.0.iter().cloned()));
        below.extend(entity.get::<Children>().into_iter().flatten());
    }
    parts.sort_by_key(|part| part.id);
    parts
}

/// A fingerprint of the [`parts`]: equal for equal ids, transforms and shapes.
pub fn digest(app: &App, environment: Entity) -> Digest {
    Digest::of(&format!("{:?}", parts(app, environment)))
}

/// The exact world of an environment that is ready.
///
/// # Panics
/// When it has none.
pub fn truth(app: &App, environment: Entity) -> GroundTruth {
    match app.world().get::<GroundTruth>(environment) {
        Some(truth) => truth.clone(),
        None => panic!("{environment} has no world"),
    }
}
