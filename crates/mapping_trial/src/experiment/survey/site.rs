//! One world of a survey with what its trials share.

use std::sync::Arc;

use envgen::World;

use super::design::{Condition, Survey, SurveyMap};
use super::record::Record;
use crate::flat::FlatWorld;
use crate::robot::Robot;
use crate::score::Reference;
use crate::trial::{Trial, TrialSettings, WorldSource};

/// One world, and for each robot that drives in it the indexed world and the reference.
pub(super) struct Site<'a> {
    map: SurveyMap<'a>,
    world: Result<World, String>,
    robots: Vec<(Robot, Result<Indexed, String>)>,
}

#[derive(Clone)]
struct Indexed {
    flat: Arc<FlatWorld>,
    reference: Arc<Reference>,
}

impl<'a> Site<'a> {
    pub(super) fn new(map: SurveyMap<'a>) -> Self {
        let blueprint = map.family.spec.generate(map.seed);
        let world = blueprint.map(|blueprint| blueprint.to_world());
        Site { map, world: world.map_err(|error| error.to_string()), robots: Vec::new() }
    }

    /// Runs a trial to its end.
    pub(super) fn run(&mut self, number: u32, condition: &Condition, noise: u32) -> Record {
        let noise_seed = Survey::noise_seed(&self.map, noise);
        let empty = Record {
            map: self.map.number,
            condition: number,
            noise,
            world_seed: self.map.seed,
            noise_seed,
            log_digest: String::new(),
            end: None,
            pose_error: 0.0,
            scores: None,
            failure: None,
        };
        let settings = condition.settings(noise_seed).map_err(|error| error.to_string());
        match settings.and_then(|settings| self.trial(settings, empty.clone())) {
            Ok(record) => record,
            Err(failure) => Record { failure: Some(failure), ..empty },
        }
    }

    fn trial(&mut self, settings: TrialSettings, empty: Record) -> Result<Record, String> {
        let Indexed { flat, reference } = self.indexed(&settings.body)?;
        let world = self.world.as_ref().map_err(String::clone)?;
        let mut trial = Trial::builder(world, settings)
            .source(WorldSource::Generated(world.provenance.clone()))
            .reference(&reference)
            .build_flat_in(flat)
            .map_err(|error| error.to_string())?;
        while trial.step() {}
        Ok(Record {
            log_digest: trial.log().digest().to_string(),
            end: trial.end_of(0).map(|end| end.reason),
            pose_error: trial.pose_error(0),
            scores: Some(trial.score(&reference).map_err(|error| error.to_string())?),
            ..empty
        })
    }

    fn indexed(&mut self, robot: &Robot) -> Result<Indexed, String> {
        if let Some((_, known)) = self.robots.iter().find(|(known, _)| known == robot) {
            return known.clone();
        }
        let index = |world: &World| {
            let flat = FlatWorld::new(world, robot).map_err(|error| error.to_string())?;
            let reference = Reference::new(world, robot).map_err(|error| error.to_string())?;
            Ok(Indexed { flat: Arc::new(flat), reference: Arc::new(reference) })
        };
        let found = self.world.as_ref().map_err(String::clone).and_then(index);
        self.robots.push((robot.clone(), found.clone()));
        found
    }
}
