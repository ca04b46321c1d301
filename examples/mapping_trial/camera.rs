//! The pictures of the robots' cameras.

use std::error::Error;
use std::path::PathBuf;

use bevy_mapping_trial::camera::{CameraRecording, CameraTrial, RobotCamera};
use bevy_mapping_trial::trial::{RapierRobots, replay_headless_with, run_headless_with};
use envgen::World;
use envgen::scenario::Scenario;
use mapping_trial::robot::Robot;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};

use crate::arguments::Arguments;

/// A trial in Rapier, and the descriptions of its pictures.
type Recorded = (Trial<RapierRobots>, Vec<PathBuf>);

/// Checks the camera, if there is one.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    match recording(arguments, &Robot::default()) {
        Some(recording) => Ok(recording.camera.check()?),
        None => Ok(()),
    }
}

/// Returns what to record of a robot, if anything.
fn recording(arguments: &Arguments, robot: &Robot) -> Option<CameraRecording> {
    let [width, height] = arguments.camera_size;
    let (field_of_view, rate) = (arguments.camera_fov, arguments.camera_rate);
    let camera = RobotCamera { width, height, field_of_view, rate, ..RobotCamera::on(robot) };
    arguments.camera.clone().map(|folder| CameraRecording { camera, folder })
}

/// Runs a trial in Rapier.
pub(crate) fn run(
    arguments: &Arguments,
    world: &World,
    settings: TrialSettings,
    (parts, scenario): (TrialParts, Option<Scenario>),
    progress: impl FnMut(f64),
) -> Result<Recorded, Box<dyn Error>> {
    Ok(match recording(arguments, &settings.body) {
        None => (run_headless_with(world, settings, parts, scenario, progress)?, Vec::new()),
        Some(recording) => {
            CameraTrial::new(world, settings, parts, scenario).record(&recording, progress)?
        }
    })
}

/// Replays a trial in Rapier.
pub(crate) fn replay(
    arguments: &Arguments,
    world: &World,
    log: TrialLog,
    parts: TrialParts,
    progress: impl FnMut(f64),
) -> Result<Recorded, Box<dyn Error>> {
    Ok(match recording(arguments, &log.settings.body) {
        None => (replay_headless_with(world, log, parts, progress)?, Vec::new()),
        Some(recording) => CameraTrial::replay(world, log, parts).record(&recording, progress)?,
    })
}
