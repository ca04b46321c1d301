//! Trials in Rapier in builds without rendering, which have no cameras.

use std::error::Error;
use std::path::PathBuf;

use bevy_mapping_trial::trial::{RapierRobots, replay_headless_with, run_headless_with};
use envgen::World;
use envgen::scenario::Scenario;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};

use crate::arguments::Arguments;

/// A trial, without pictures.
type Recorded = (Trial<RapierRobots>, Vec<PathBuf>);

/// Rejects cameras.
pub(crate) fn check(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if arguments.camera.is_some() {
        return Err("--camera needs a build that draws: \
                    `cargo run --release --features window --example mapping_trial -- ...`"
            .into());
    }
    Ok(())
}

/// Runs a trial in Rapier.
pub(crate) fn run(
    _: &Arguments,
    world: &World,
    settings: TrialSettings,
    (parts, scenario): (TrialParts, Option<Scenario>),
    progress: impl FnMut(f64),
) -> Result<Recorded, Box<dyn Error>> {
    Ok((run_headless_with(world, settings, parts, scenario, progress)?, Vec::new()))
}

/// Replays a trial in Rapier.
pub(crate) fn replay(
    _: &Arguments,
    world: &World,
    log: TrialLog,
    parts: TrialParts,
    progress: impl FnMut(f64),
) -> Result<Recorded, Box<dyn Error>> {
    Ok((replay_headless_with(world, log, parts, progress)?, Vec::new()))
}
