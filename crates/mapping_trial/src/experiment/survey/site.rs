//! A world, with the data that its trials share.

use std::fmt::Display;
use std::sync::{Arc, Mutex, PoisonError};

use envgen::scenario::Scenario;
use envgen::{Seed, World};

use super::design::Condition;
use crate::driver::{Driver, Hello, Limits, command};
use crate::flat::{FlatSimulator, FlatWorld};
use crate::robot::Robot;
use crate::score::{Reference, Scores};
use crate::trial::{EndReason, LogWorld, Trial, TrialBuilder};

/// A world, with its index and its reference for each robot that drives in it.
pub(crate) struct Site {
    world: World,
    source: LogWorld,
    robots: Mutex<Vec<(Robot, Result<Indexed, String>)>>,
}

/// How a trial ended.
pub(crate) struct Outcome {
    pub(crate) log_digest: String,
    pub(crate) end: Option<EndReason>,
    /// Distance in metres between the last estimated position and the true one.
    pub(crate) pose_error: f64,
    pub(crate) scores: Scores,
}

/// Why a trial has no outcome.
#[derive(Clone, Debug)]
pub(crate) enum Failure {
    /// No trial can run in the world.
    World(String),
    /// The driver failed, which says nothing about the world.
    Driver(String),
}

impl Failure {
    pub(crate) fn world(error: impl Display) -> Self {
        Failure::World(error.to_string())
    }

    fn driver(error: impl Display) -> Self {
        Failure::Driver(error.to_string())
    }
}

/// A trial that can begin.
struct Prepared {
    trial: Trial<FlatSimulator>,
    reference: Arc<Reference>,
    driver: Option<Driver>,
}

#[derive(Clone)]
struct Indexed {
    flat: Arc<FlatWorld>,
    reference: Arc<Reference>,
}

impl Site {
    pub(crate) fn new(world: World, source: LogWorld) -> Self {
        Site { world, source, robots: Mutex::default() }
    }

    /// Prepares a trial under a condition, with its driver if there is one, and returns why it cannot run.
    pub(crate) fn check(&self, condition: &Condition, noise: Seed) -> Result<(), Failure> {
        match self.prepare(condition, noise)?.driver {
            Some(driver) => {
                driver.end(None);
                driver.failure().map_or(Ok(()), |reason| Err(Failure::driver(reason)))
            }
            None => Ok(()),
        }
    }

    fn prepare(&self, condition: &Condition, noise: Seed) -> Result<Prepared, Failure> {
        let settings = condition.settings(noise).map_err(Failure::world)?;
        let Indexed { flat, reference } = self.indexed(&settings.body).map_err(Failure::World)?;
        let mut builder =
            Trial::builder(&self.world, settings).source(self.source.clone()).reference(&reference);
        if !condition.scenario.is_still() {
            let seed = self.world.provenance.seed.unwrap_or_default();
            let scenario = Scenario::new(&self.world, &condition.scenario, seed);
            builder = builder.scenario(scenario.map_err(Failure::world)?);
        }
        let driver = condition.driver.as_deref();
        let driver = driver.map(|line| start(line, &mut builder)).transpose()?;
        if let Some(driver) = &driver {
            builder = builder.parts(driver.parts());
        }
        let trial = builder.build_flat_in(flat).map_err(Failure::world)?;
        Ok(Prepared { trial, reference, driver })
    }

    /// Runs a trial under a condition to its end, or returns why it cannot run.
    pub(crate) fn run(&self, condition: &Condition, noise: Seed) -> Result<Outcome, Failure> {
        let Prepared { mut trial, reference, driver } = self.prepare(condition, noise)?;
        while trial.step() {}
        if let Some(driver) = driver {
            if let Some(reason) = driver.failure() {
                return Err(Failure::driver(reason));
            }
            let report = trial.report(&self.world, &reference).map_err(Failure::world)?;
            driver.end(Some(&report));
            if let Some(reason) = driver.failure() {
                return Err(Failure::driver(reason));
            }
        }
        Ok(Outcome {
            log_digest: trial.log().digest().to_string(),
            end: trial.end_of(0).map(|end| end.reason),
            pose_error: trial.pose_error(0),
            scores: trial.score(&reference).map_err(Failure::world)?,
        })
    }

    /// Returns the world for a robot. While the first thread indexes it, other threads wait.
    fn indexed(&self, robot: &Robot) -> Result<Indexed, String> {
        let mut robots = self.robots.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = robots.iter().find(|(known, _)| known == robot) {
            return known.clone();
        }
        let index = |world: &World| {
            let flat = FlatWorld::new(world, robot).map_err(|error| error.to_string())?;
            let reference = Reference::new(world, robot).map_err(|error| error.to_string())?;
            Ok(Indexed { flat: Arc::new(flat), reference: Arc::new(reference) })
        };
        let found = index(&self.world);
        robots.push((robot.clone(), found.clone()));
        found
    }
}

/// Starts the driver of a trial, up to its answer to the hello. Its standard error is discarded, except
/// for the last line of a driver that fails, since many run at once.
fn start(line: &str, builder: &mut TrialBuilder<'_>) -> Result<Driver, Failure> {
    let hello = Hello::new(&builder.setup().map_err(Failure::world)?);
    let command = command(line).map_err(Failure::driver)?;
    let driver =
        Driver::start(command, Limits::default(), std::io::sink()).map_err(Failure::driver)?;
    driver.greet(&hello);
    match driver.failure() {
        Some(reason) => Err(Failure::driver(reason)),
        None => Ok(driver),
    }
}
