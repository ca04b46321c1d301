//! The state of an environment from the request to the report, shared by the systems of generation, streaming
//! and assets.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use bevy::prelude::*;
use bevy::tasks::Task;
#[cfg(feature = "asset")]
use envgen::WorldSpec;
use envgen::forest::EndlessForest;
use envgen::glam::DVec2;

use crate::environment::{Environment, EnvironmentError, SpawnedOrigin};
use crate::plan::{Plan, TileKey};

/// A component with the state of the generation of an environment's world.
#[derive(Component, Default)]
pub(crate) struct GenerationJob {
    /// The last request.
    pub(crate) asked: Option<Request>,
    /// The number of requests so far.
    pub(crate) requests: u64,
    /// Whether the world must be rebuilt although the environment has not changed.
    pub(crate) stale: bool,
    /// The spec of the asset when it was last used.
    #[cfg(feature = "asset")]
    pub(crate) spec: Option<WorldSpec>,
    pub(crate) job: Job,
}

/// Everything that a world depends on.
#[derive(Clone, PartialEq)]
pub(crate) struct Request {
    pub(crate) environment: Environment,
    /// The side of the tiles in metres, if the world is streamed.
    pub(crate) tile: Option<f64>,
}

#[derive(Default)]
pub(crate) enum Job {
    #[default]
    Idle,
    /// The request waits for an asset that is not loaded.
    #[cfg_attr(
        not(feature = "asset"),
        expect(dead_code, reason = "without assets, no request waits")
    )]
    Asset,
    Task(Task<Outcome>),
    Done(Outcome),
}

/// The result of a job.
pub(crate) struct Outcome {
    pub(crate) result: Result<Generated, EnvironmentError>,
    /// How long the generator took.
    pub(crate) time: Duration,
}

impl From<EnvironmentError> for Outcome {
    fn from(error: EnvironmentError) -> Self {
        Outcome { result: Err(error), time: Duration::ZERO }
    }
}

/// A generated world, sorted into tiles.
#[derive(Clone)]
pub(crate) enum Generated {
    Finite(Arc<Plan>),
    Endless(Arc<EndlessForest>),
}

/// A component with the tiles that are spawned below an environment.
#[derive(Component, Default)]
pub(crate) struct SpawnedTiles {
    pub(crate) tiles: BTreeMap<TileKey, Vec<Entity>>,
    /// Whether the world is despawned because the transform is invalid.
    pub(crate) suspended: bool,
}

/// Returns the origin of the world that is spawned below an environment.
pub(crate) fn spawned_origin(world: &World, environment: Entity) -> DVec2 {
    world.get::<SpawnedOrigin>(environment).map_or(DVec2::ZERO, |origin| origin.0)
}

/// A resource with the events to trigger once the world is consistent.
#[derive(Resource, Default)]
pub(crate) struct PendingEvents(pub(crate) Vec<(Entity, Result<(), EnvironmentError>)>);

impl PendingEvents {
    pub(crate) fn push(&mut self, entity: Entity, notice: Result<(), EnvironmentError>) {
        self.0.push((entity, notice));
    }
}

impl GenerationJob {
    /// Returns whether the world of the request with a given number is spawned, and no other has been
    /// requested since.
    pub(crate) fn is_settled(&self, request: u64) -> bool {
        matches!(self.job, Job::Idle) && !self.stale && self.requests == request
    }

    /// Returns whether the request waits for an asset.
    #[cfg(feature = "asset")]
    pub(crate) fn waits(&self) -> bool {
        matches!(self.job, Job::Asset)
    }

    /// Stops waiting, or reports that the spawned world has lost its source.
    #[cfg(feature = "asset")]
    pub(crate) fn fail(&mut self, error: EnvironmentError) {
        self.job = Job::Done(error.into());
        self.requests += 1;
        // If the same spec is loaded again, the error is fixed.
        self.spec = None;
    }

    /// Waits for the running task, and returns whether there was one.
    #[cfg(feature = "testing")]
    pub(crate) fn finish(&mut self) -> bool {
        let Job::Task(task) = &mut self.job else { return false };
        self.job = Job::Done(bevy::tasks::block_on(task));
        true
    }
}
