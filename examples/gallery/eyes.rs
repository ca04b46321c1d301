//! A film through the eyes of a robot that maps a building with people in it.

use std::error::Error;
use std::path::Path;

use bevy_mapping_trial::camera::{CameraTrial, RobotCamera};
use envgen::Seed;
use envgen::scenario::{Scenario, ScenarioSpec};
use mapping_trial::trial::{Trial, TrialParts, TrialSettings};

use crate::worlds::spec;

/// The building, and what moves in it.
const SETTINGS: &[(&str, &str)] = &[("difficulty", "5"), ("width", "10"), ("height", "8")];
const MOVING: &[(&str, &str)] = &[("doors", "0.8"), ("people", "12")];
const SEED: u64 = 4;

/// Simulated seconds.
const TIME_LIMIT: f64 = 30.0;

/// The film is this many times as fast as the trial.
const SPEED: f64 = 4.0;

/// What the robot sees. Returns the simulated seconds.
pub(crate) fn film(path: &Path) -> Result<f64, Box<dyn Error>> {
    let world = spec("indoor", SETTINGS)?.generate(Seed(SEED))?.to_world();
    let mut moving = ScenarioSpec::default();
    for (name, value) in MOVING {
        moving.set(name, value)?;
    }
    let scenario = Scenario::new(&world, &moving, Seed(SEED))?;
    let settings = TrialSettings {
        seed: Seed(SEED),
        start: world.start,
        time_limit: TIME_LIMIT,
        ..Default::default()
    };
    let camera = RobotCamera {
        field_of_view: 80.0,
        width: 192,
        height: 144,
        rate: 2.0,
        ..Default::default()
    };
    let frames_per_second = SPEED * camera.rate;
    let trial = CameraTrial::new(&world, settings, TrialParts::default(), Some(scenario));
    Ok(trial.film(camera, (path, frames_per_second), |_| ()).map(|trial| Trial::time(&trial))?)
}
