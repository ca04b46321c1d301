//! The state of an environment between the request and the report, shared by the systems of
//! generation, streaming and assets.

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

/// The generation of an environment's world.
#[derive(Component, Default)]
pub(crate) struct GenerationJob {
    /// The last request.
    pub(crate) asked: Option<Request>,
    /// Counts the requests.
    pub(crate) requests: u64,
    /// Whether it must be rebuilt although the environment did not change.
    pub(crate) stale: bool,
    /// The spec that the asset held when it was last used.
    #[cfg(feature = "asset")]
    pub(crate) spec: Option<WorldSpec>,
    pub(crate) job: Job,
}

/// Everything that a world depends on.
#[derive(Clone, PartialEq)]
pub(crate) struct Request {
    pub(crate) environment: Environment,
    /// The side of its tiles in metres, when it is streamed.
    pub(crate) tile: Option<f64>,
}

#[derive(Default)]
pub(crate) enum Job {
    #[default]
    Idle,
    /// The asset is not loaded.
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

/// The tiles that are spawned below an environment.
#[derive(Component, Default)]
pub(crate) struct SpawnedTiles {
    pub(crate) tiles: BTreeMap<TileKey, Vec<Entity>>,
    /// Whether it is despawned because its transform is invalid.
    pub(crate) suspended: bool,
}

/// The origin of the world that is spawned below an environment.
pub(crate) fn spawned_origin(world: &World, environment: Entity) -> DVec2 {
    world.get::<SpawnedOrigin>(environment).map_or(DVec2::ZERO, |origin| origin.0)
}

/// Events to send once the world is consistent.
#[derive(Resource, Default)]
pub(crate) struct PendingEvents(pub(crate) Vec<(Entity, Result<(), EnvironmentError>)>);

impl PendingEvents {
    pub(crate) fn push(&mut self, entity: Entity, notice: Result<(), EnvironmentError>) {
        self.0.push((entity, notice));
    }
}

impl GenerationJob {
    /// Whether the world of a request is spawned, by its number, and no other has been requested since.
    pub(crate) fn is_settled(&self, request: u64) -> bool {
        matches!(self.job, Job::Idle) && !self.stale && self.requests == request
    }

    /// Whether it waits for an asset.
    #[cfg(feature = "asset")]
    pub(crate) fn waits(&self) -> bool {
        matches!(self.job, Job::Asset)
    }

    /// Stops waiting, or reports that the spawned world has lost its source.
    #[cfg(feature = "asset")]
    pub(crate) fn fail(&mut self, error: EnvironmentError) {
        self.job = Job::Done(error.into());
        self.requests += 1;
        // The same spec again is a repair.
        self.spec = None;
    }

    /// Waits for its task; false when it has none.
    #[cfg(feature = "testing")]
    pub(crate) fn finish(&mut self) -> bool {
        let Job::Task(task) = &mut self.job else { return false };
        self.job = Job::Done(bevy::tasks::block_on(task));
        true
    }
}
