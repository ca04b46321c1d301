//! Films what a robot sees that maps a building with people in it.

use std::error::Error;
use std::path::Path;

use bevy_mapping_trial::camera::{CameraTrial, RobotCamera};
use envgen::Seed;
use envgen::scenario::{Scenario, ScenarioSpec};
use mapping_trial::trial::{Trial, TrialParts, TrialSettings};

use crate::worlds::spec;

/// Settings of the building.
const SETTINGS: &[(&str, &str)] = &[("difficulty", "5"), ("width", "10"), ("height", "8")];
const MOVING: &[(&str, &str)] = &[("doors", "0.8"), ("people", "12")];
const SEED: u64 = 4;

/// Time limit in simulated seconds.
const TIME_LIMIT: f64 = 30.0;

/// Speed of the film relative to the trial.
const SPEED: f64 = 4.0;

/// Films what the robot sees. Returns the simulated time in seconds.
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
