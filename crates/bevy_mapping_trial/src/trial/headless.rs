//! Runs trials in a headless app that is created for them.

use std::sync::Arc;
use std::time::Duration;

use bevy::app::{PluginsState, TaskPoolPlugin};
use bevy::prelude::*;
use bevy::time::{TimePlugin, TimeUpdateStrategy};
use bevy_envgen::physics::{ColliderSettings, EnvgenPhysicsPlugin, TopDownPhysicsPlugin};
use bevy_envgen::{
    EnvgenCorePlugin, EnvgenScenarioPlugin, Environment, EnvironmentError, EnvironmentFailure,
    EnvironmentScenario, GenerationMode, run_on_one_thread,
};
use envgen::scenario::Scenario;
use mapping_trial::backend::TICK;
use mapping_trial::trial::{Trial, TrialLog, TrialParts, TrialSettings};
use thiserror::Error;

use super::bodies::RapierRobots;
use super::component::MappingTrial;
use super::error::MappingTrialError;
use super::event::TrialFailed;
use super::physics::ForTrials;
use super::plugin::TrialPlugin;

/// The number of ticks between two calls of the progress callback.
const TICKS_PER_CALL: u64 = 200;

/// An error that prevents a headless trial.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HeadlessError {
    /// The world is invalid.
    #[error(transparent)]
    World(#[from] EnvironmentError),
    /// The trial cannot begin.
    #[error(transparent)]
    Trial(#[from] MappingTrialError),
    /// The trial did not begin, for an unknown reason.
    #[error("the trial did not begin")]
    Stalled,
}

/// Runs a trial in rapier to its end, as fast as possible and on the current thread only. `progress` is
/// called from time to time with the simulated seconds so far.
///
/// # Errors
///
/// Returns an error if the world is invalid, if a setting is out of range, or if the start is not free.
pub fn run_headless(
    world: &envgen::World,
    settings: TrialSettings,
    progress: impl FnMut(f64),
) -> Result<Trial<RapierRobots>, HeadlessError> {
    run_headless_with(world, settings, TrialParts::default(), None, progress)
}

/// Runs a trial as `run_headless` does, with a custom SLAM, exploration policy or sensors in place of those
/// of the settings, and with doors, people and smoke.
///
/// # Errors
///
/// Returns the errors of [`run_headless`], and an error if the scenario does not fit the world.
pub fn run_headless_with(
    world: &envgen::World,
    settings: TrialSettings,
    parts: TrialParts,
    scenario: Option<Scenario>,
    progress: impl FnMut(f64),
) -> Result<Trial<RapierRobots>, HeadlessError> {
    let trial = MappingTrial::new(settings).with_parts(parts);
    drive(&mut app(), world.clone(), trial, scenario, progress, |_| ())
}

/// Replays a log of engine [`ENGINE`](super::ENGINE) in `world`, which must be the world of the log.
///
/// # Errors
///
/// Returns the errors of [`run_headless`], and an error if the world or the engine is not that of the log.
pub fn replay_headless(
    world: &envgen::World,
    log: TrialLog,
    progress: impl FnMut(f64),
) -> Result<Trial<RapierRobots>, HeadlessError> {
    replay_headless_with(world, log, TrialParts::default(), progress)
}

/// Replays a log as `replay_headless` does, with an observer, or with the custom parts with which the log was
/// made.
///
/// # Errors
///
/// Returns the errors of [`replay_headless`].
pub fn replay_headless_with(
    world: &envgen::World,
    log: TrialLog,
    parts: TrialParts,
    progress: impl FnMut(f64),
) -> Result<Trial<RapierRobots>, HeadlessError> {
    let scenario = log.scenario.clone();
    let trial = MappingTrial::replay(log).with_parts(parts);
    drive(&mut app(), world.clone(), trial, scenario, progress, |_| ())
}

/// A resource with the last error that prevented the trial.
#[derive(Resource)]
struct Failure(MappingTrialError);

/// Runs a trial to its end in an app in which each update is a tick, and calls `ticked` after each tick.
pub(crate) fn drive(
    app: &mut App,
    world: envgen::World,
    trial: MappingTrial,
    scenario: Option<Scenario>,
    mut progress: impl FnMut(f64),
    mut ticked: impl FnMut(&mut App),
) -> Result<Trial<RapierRobots>, HeadlessError> {
    let world = Arc::new(world);
    let environment = Environment::prebuilt(Arc::clone(&world))
        .with_origin_near(&world)
        .with_pace(GenerationMode::Blocking);
    let mut root = app.world_mut().spawn((environment, trial));
    if let Some(scenario) = scenario {
        root.insert(EnvironmentScenario::prebuilt(scenario));
    }
    let entity = root.id();
    let mut ticks = 0_u64;
    loop {
        app.update();
        ticked(app);
        ticks += 1;
        if let Some(Failure(error)) = app.world_mut().remove_resource() {
            return Err(error.into());
        }
        let mut root = app.world_mut().entity_mut(entity);
        if let Some(failure) = root.get::<EnvironmentFailure>() {
            return Err(failure.0.clone().into());
        }
        let trial = root.get::<MappingTrial>().ok_or(HeadlessError::Stalled)?;
        if trial.is_over() {
            let trial = root.take::<MappingTrial>().and_then(MappingTrial::into_trial);
            return trial.ok_or(HeadlessError::Stalled);
        }
        let time = trial.trial().map(Trial::time);
        if time.is_none() && ticks > TICKS_PER_CALL {
            return Err(HeadlessError::Stalled);
        }
        if ticks.is_multiple_of(TICKS_PER_CALL) {
            progress(time.unwrap_or(0.0));
        }
    }
}

/// Creates an app in which each update is a tick, with only the plugins that a trial needs.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin));
    set_up(&mut app);
    app
}

/// Adds the plugins that a trial needs to an app with clocks and transforms, and makes each update a tick.
pub(crate) fn set_up(app: &mut App) {
    app.add_plugins((
        TopDownPhysicsPlugin::for_trials(),
        EnvgenCorePlugin::default(),
        EnvgenScenarioPlugin::default(),
        EnvgenPhysicsPlugin::default().with_colliders(ColliderSettings::for_trials()),
        TrialPlugin::default(),
    ));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(TICK)));
    app.add_observer(|failed: On<TrialFailed>, mut commands: Commands| {
        commands.insert_resource(Failure(failed.error.clone()));
    });
    run_on_one_thread(app);
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}
