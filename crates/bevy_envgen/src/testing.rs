//! Helpers for tests of apps that use this crate: an app whose time advances in steps, and access to what is
//! spawned in it. They need the feature `testing`, which is meant for dev-dependencies.
//!
//! ```
//! use bevy_envgen::prelude::*;
//! use bevy_envgen::testing::{parts, spawn_ready, test_app};
//!
//! let mut app = test_app();
//! let hallway = spawn_ready(&mut app, Environment::new(HallwaySpec::default(), 7))?;
//! assert!(parts(&app, hallway).iter().any(|part| part.id.kind == PartKind::Wall));
//! # Ok::<(), bevy_envgen::EnvironmentError>(())
//! ```

use std::time::Duration;

use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use envgen::world::Digest;

use crate::environment::{
    Environment, EnvironmentError, EnvironmentFailure, EnvironmentState, GroundTruth,
};
use crate::generate::finish_tasks;
use crate::{
    EnvgenPlugins, HeightRange, PartId, PartShape, SolidPart, TileSolids, run_on_one_thread,
};

/// The number of fixed steps per second of [`test_app`].
pub const STEPS_A_SECOND: f64 = 64.0;

/// The largest number of frames that [`wait_until_ready`] waits. While a file is loaded, a frame takes at
/// least one millisecond.
const MOST_FRAMES: usize = 60_000;

/// Creates a headless app with every plugin of this crate and the plugins that they need. A frame is exactly
/// one fixed step of 1/64 s. The app is finished and has run its first frame, which is empty. Its systems
/// [run on one thread](crate::run_on_one_thread).
pub fn test_app() -> App {
    test_app_with(EnvgenPlugins::default())
}

/// Creates the app of `test_app` with assets from `folder`. With the feature `file_watcher`, files that
/// change are reloaded.
#[cfg(feature = "asset")]
pub fn test_app_in(folder: &std::path::Path) -> App {
    let file_path = folder.to_string_lossy().into_owned();
    finished(AssetPlugin { file_path, ..default() }, EnvgenPlugins::default())
}

/// Creates the app of `test_app` with the given plugins in place of those of this crate.
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
    run_on_one_thread(&mut app);
    app.finish();
    app.cleanup();
    // Time does not advance in the first frame.
    app.update();
    app
}

/// Runs `frames` frames. In a [`test_app`] each is one fixed step.
pub fn step(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

/// Runs frames until an environment is ready or has failed. It waits for the tasks of the environment. While
/// other threads load a file of its spec, each frame waits for a millisecond.
///
/// # Errors
/// Returns the error of the environment if it has failed.
///
/// # Panics
/// Panics if the environment is neither ready nor failed after 60,000 frames, or if the entity has no
/// [`Environment`].
pub fn wait_until_ready(app: &mut App, environment: Entity) -> Result<(), EnvironmentError> {
    for _ in 0..MOST_FRAMES {
        app.update();
        let root = app.world().entity(environment);
        match (root.get::<EnvironmentState>(), root.get::<EnvironmentFailure>()) {
            (Some(EnvironmentState::Ready), _) => return Ok(()),
            (Some(EnvironmentState::Failed), Some(failure)) => return Err(failure.0.clone()),
            (Some(EnvironmentState::Waiting), _) => {
                std::thread::sleep(Duration::from_millis(1));
            }
            (Some(_), _) => {
                finish_tasks(app.world_mut(), environment);
            }
            (None, _) => panic!("{environment} has no `Environment`"),
        }
    }
    panic!("{environment} is neither ready nor failed after {MOST_FRAMES} frames");
}

/// Spawns an environment and waits until it is ready.
///
/// # Errors
/// Returns the error of the environment if it has failed.
pub fn spawn_ready(app: &mut App, environment: Environment) -> Result<Entity, EnvironmentError> {
    let environment = app.world_mut().spawn(environment).id();
    wait_until_ready(app, environment).map(|()| environment)
}

/// Returns the parts below an environment, both entities and data, in the order of their ids.
pub fn parts(app: &App, environment: Entity) -> Vec<SolidPart> {
    let mut parts = Vec::new();
    let mut below = vec![environment];
    while let Some(entity) = below.pop() {
        let Ok(entity) = app.world().get_entity(entity) else { continue };
        if let (Some(id), Some(transform), Some(shape)) =
            (entity.get::<PartId>(), entity.get::<Transform>(), entity.get::<PartShape>())
        {
            let height = entity.get::<HeightRange>().copied();
            parts.push(SolidPart { id: *id, transform: *transform, shape: shape.clone(), height });
        }
        parts
            .extend(entity.get::<TileSolids>().into_iter().flat_map(|data| data.0.iter().cloned()));
        below.extend(entity.get::<Children>().into_iter().flatten());
    }
    parts.sort_by_key(|part| part.id);
    parts
}

/// Returns a digest of the [`parts`]. It is equal if the ids, transforms and shapes are equal to the last
/// bit.
pub fn digest(app: &App, environment: Entity) -> Digest {
    let parts = parts(app, environment);
    let parts: Vec<_> = parts
        .iter()
        .map(|part| {
            let PartId { kind, tile, index } = part.id;
            // Digests have always used spaces in the names of kinds.
            let kind = kind.name().replace('_', " ");
            (kind, tile, index, transform_bits(&part.transform), shape_bits(&part.shape))
        })
        .collect();
    Digest::of(&parts)
}

fn transform_bits(transform: &Transform) -> Vec<u32> {
    let Transform { translation, rotation, scale } = transform;
    let numbers = [&translation.to_array()[..], &rotation.to_array(), &scale.to_array()];
    numbers.into_iter().flatten().map(|number| number.to_bits()).collect()
}

/// Returns a shape as its name and the bits of its numbers.
fn shape_bits(shape: &PartShape) -> (&'static str, Vec<u32>) {
    let bits = |numbers: &[f32]| numbers.iter().map(|number| number.to_bits()).collect();
    let points = |points: &[Vec2]| -> Vec<u32> {
        points.iter().flat_map(|point| point.to_array()).map(f32::to_bits).collect()
    };
    match shape {
        PartShape::Point => ("point", Vec::new()),
        PartShape::Segment { half_length } => ("segment", bits(&[*half_length])),
        PartShape::Disc { radius } => ("disc", bits(&[*radius])),
        PartShape::Box { half_size } => ("box", points(&[*half_size])),
        PartShape::Polygon { vertices } => ("polygon", points(vertices)),
        PartShape::Strip { centreline, width, closed } => {
            let mut numbers = points(centreline);
            numbers.extend([width.to_bits(), u32::from(*closed)]);
            ("strip", numbers)
        }
    }
}

/// Returns the numbers of colliders and of bodies in rapier's own sets.
///
/// # Panics
/// Panics if the app has no rapier context, or if a collider in it belongs to no entity.
#[cfg(feature = "physics")]
pub fn in_rapier(app: &mut App) -> (usize, usize) {
    use bevy_rapier2d::prelude::{RapierContextColliders, RapierRigidBodySet};

    let mut sets = app.world_mut().query::<(&RapierContextColliders, &RapierRigidBodySet)>();
    let Ok((colliders, bodies)) = sets.single(app.world()) else { panic!("rapier has no context") };
    assert_eq!(colliders.colliders.len(), colliders.entity2collider().len());
    (colliders.colliders.len(), bodies.bodies.len())
}

/// A system set without systems.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
struct Checked;

/// Makes the app panic if two of its systems in `Update`, `FixedUpdate` or `PostUpdate` access the same data
/// in an undefined order.
pub fn refuse_ambiguities(app: &mut App) {
    for schedule in [Update.intern(), FixedUpdate.intern(), PostUpdate.intern()] {
        app.edit_schedule(schedule, |schedule| {
            let ambiguity_detection = LogLevel::Error;
            schedule.set_build_settings(ScheduleBuildSettings { ambiguity_detection, ..default() });
            // A schedule that has run is built again only if it has changed.
            schedule.configure_sets(Checked);
        });
    }
}

/// Returns the exact world of an environment that is ready.
///
/// # Panics
/// Panics if the environment has no world.
pub fn truth(app: &App, environment: Entity) -> GroundTruth {
    match app.world().get::<GroundTruth>(environment) {
        Some(truth) => truth.clone(),
        None => panic!("{environment} has no world"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a digest distinguishes values that look the same when printed with a few digits.
    #[test]
    fn digests_see_single_bits() {
        let next = |x: f32| f32::from_bits(x.to_bits() + 1);
        let at = |x: f32| transform_bits(&Transform::from_xyz(x, 0.0, 0.0));
        assert_ne!(at(1.0), at(next(1.0)));
        assert_ne!(at(0.0), at(-0.0));
        let closed =
            |closed| PartShape::Strip { centreline: vec![Vec2::ZERO, Vec2::X], width: 2.0, closed };
        let shapes = [
            PartShape::Point,
            PartShape::Segment { half_length: 1.0 },
            PartShape::Segment { half_length: next(1.0) },
            PartShape::Disc { radius: 1.0 },
            PartShape::Box { half_size: Vec2::ONE },
            PartShape::Box { half_size: Vec2::new(1.0, next(1.0)) },
            PartShape::Polygon { vertices: vec![Vec2::ZERO, Vec2::X, Vec2::Y] },
            PartShape::Polygon { vertices: vec![Vec2::ZERO, Vec2::Y, Vec2::X] },
            closed(false),
            closed(true),
        ];
        for (i, a) in shapes.iter().enumerate() {
            for (j, b) in shapes.iter().enumerate() {
                assert_eq!(shape_bits(a) == shape_bits(b), i == j, "{a:?} {b:?}");
            }
        }
    }
}
