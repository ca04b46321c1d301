//! The maps of an experiment, each computed once for all its trials.

use std::collections::BTreeMap;
use std::error::Error;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

use envgen::{Blueprint, Spec, World};

use super::design::{Design, TrialId};
use super::error::ExperimentError;
use super::record::{MapFeatures, Record};
use crate::flat::{FlatSimulator, FlatWorld};
use crate::robot::Robot;
use crate::score::Reference;
use crate::trial::{LogWorld, Trial};

/// A map on which trials take place.
pub(super) struct Site {
    pub(super) world: World,
    pub(super) truth: Reference,
    flat: Arc<FlatWorld>,
    features: MapFeatures,
    digest: String,
}

impl Site {
    /// Generates the map of a trial.
    pub(super) fn new(design: &Design, trial: &TrialId) -> Result<Self, ExperimentError> {
        let plan = design.spec(design.level(trial)).generate(design.world_seed(trial));
        let plan = plan.map_err(|error| unusable(design, trial, &error))?;
        let world = plan.to_world();
        let body = Robot::default();
        let flat =
            FlatWorld::new(&world, &body).map_err(|error| unusable(design, trial, &error))?;
        Ok(Site {
            truth: Reference::new(&world, &body)
                .map_err(|error| unusable(design, trial, &error))?,
            flat: Arc::new(flat),
            features: MapFeatures::of(&plan),
            digest: world.digest().to_string(),
            world,
        })
    }

    /// Runs a trial to its end.
    pub(super) fn run(
        &self,
        design: &Design,
        trial: &TrialId,
    ) -> Result<(Record, Trial<FlatSimulator>), ExperimentError> {
        let failed = |error: &dyn Error| unusable(design, trial, error);
        let settings = design.settings(trial);
        let mut run = Trial::builder(&self.world, settings)
            .source(LogWorld::Generated(self.world.provenance.clone()))
            .reference(&self.truth)
            .build_flat_in(Arc::clone(&self.flat))
            .map_err(|error| failed(&error))?;
        while run.step() {}
        let record = Record {
            trial: *trial,
            world_seed: design.world_seed(trial),
            noise_seed: design.noise_seed(trial),
            world_digest: self.digest.clone(),
            log_digest: run.log().digest().to_string(),
            end: run.end_of(0).map(|end| end.reason),
            pose_error: Some(run.pose_error(0)),
            features: self.features.clone(),
            scores: run.score(&self.truth).map_err(|error| failed(&error))?,
        };
        Ok((record, run))
    }
}

fn unusable(design: &Design, trial: &TrialId, error: &dyn Error) -> ExperimentError {
    ExperimentError::Map {
        map: trial.map,
        level: design.level(trial),
        seed: design.world_seed(trial),
        reason: error.to_string(),
    }
}

/// The maps that are in use.
#[derive(Default)]
pub(super) struct Sites {
    known: Mutex<BTreeMap<(u32, u32), Weak<Slot>>>,
}

/// A map that the first thread that needs it computes, while other threads wait.
type Slot = OnceLock<Result<Site, ExperimentError>>;

/// A handle that keeps a map in memory.
#[derive(Clone)]
pub(super) struct Held(Arc<Slot>);

impl Sites {
    /// Returns the handle of a trial's map.
    pub(super) fn hold(&self, trial: &TrialId) -> Held {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = known.entry((trial.level, trial.map)).or_default();
        let held = slot.upgrade().unwrap_or_else(|| {
            let new = Arc::new(Slot::new());
            *slot = Arc::downgrade(&new);
            new
        });
        Held(held)
    }
}

impl Held {
    /// Returns the map itself.
    pub(super) fn site(&self, design: &Design, trial: &TrialId) -> Result<&Site, ExperimentError> {
        self.0.get_or_init(|| Site::new(design, trial)).as_ref().map_err(ExperimentError::again)
    }
}
