//! The scenario that a trial needs, in place of that of its environment if it is a replay.

use bevy::prelude::*;
use bevy_envgen::scenario::RestartScenario;
use bevy_envgen::{EnvironmentScenario, ScenarioFailure, ScenarioRun};

use super::component::{MappingTrial, Request};
use super::error::MappingTrialError;

/// A component with the request for a scenario that a replay has replaced or removed, on the same entity.
/// Clones hold it, so that their requests can be restored.
#[derive(Component, Clone)]
pub(super) struct ReplacedScenario {
    before: Option<EnvironmentScenario>,
    during: Option<EnvironmentScenario>,
}

impl ReplacedScenario {
    /// Creates the component for a replay that replaces `request` by `during`. A request of an earlier replay
    /// is not one of the app.
    fn new(
        request: Option<&EnvironmentScenario>,
        replaced: Option<&ReplacedScenario>,
        during: Option<&EnvironmentScenario>,
    ) -> Self {
        let before = match replaced {
            Some(replaced) if request == replaced.during.as_ref() => replaced.before.clone(),
            _ => request.cloned(),
        };
        ReplacedScenario { before, during: during.cloned() }
    }
}

/// Prepares the scenario of an environment for a trial. A replay needs the scenario of its log. The scenario
/// must be at its beginning, paused until the robots are ready. Returns whether the trial can begin.
pub(super) fn prepare(
    ask: &Request,
    (request, replaced): (Option<&EnvironmentScenario>, Option<&ReplacedScenario>),
    moving: Option<&mut ScenarioRun>,
    failure: Option<&ScenarioFailure>,
    root: &mut EntityCommands<'_>,
) -> Result<bool, MappingTrialError> {
    if let Request::Replay(log) = ask {
        match &log.scenario {
            Some(logged) if moving.as_ref().is_none_or(|moving| moving.scenario() != logged) => {
                let wanted = EnvironmentScenario::prebuilt(logged.clone());
                if request != Some(&wanted) {
                    let replaced = ReplacedScenario::new(request, replaced, Some(&wanted));
                    root.insert((wanted, replaced)).remove::<ScenarioFailure>();
                    return Ok(false);
                }
                return failure.map_or(Ok(false), |failure| Err(failure.0.clone().into()));
            }
            None if request.is_some() => {
                root.insert(ReplacedScenario::new(request, replaced, None));
                root.remove::<EnvironmentScenario>();
                return Ok(false);
            }
            _ => {}
        }
    }
    let is_replay = matches!(ask, Request::Replay(_));
    // An app may command doors before the first tick.
    let waits = |moving: &ScenarioRun| {
        let is_ours = !is_replay || moving.ignores_commands();
        moving.is_paused() && moving.state().tick() == 0 && is_ours
    };
    match (request, moving, failure) {
        (None, None, _) => Ok(true),
        (_, _, Some(failure)) => Err(failure.0.clone().into()),
        (_, Some(moving), None) if waits(moving) => Ok(true),
        (_, Some(moving), None) => {
            // The scenario is restarted with new entities, so that rapier has no memory of the old ones.
            moving.set_paused(true);
            moving.set_ignores_commands(is_replay);
            root.trigger(|entity| RestartScenario { entity });
            Ok(false)
        }
        (Some(_), None, None) => Ok(false),
    }
}

/// Resumes a scenario that a trial has paused.
pub(super) fn release(moving: Option<&mut ScenarioRun>) {
    if let Some(moving) = moving {
        moving.set_paused(false);
        moving.set_ignores_commands(false);
    }
}

/// Restores the request for a scenario that a replay has replaced, when the replay is removed.
pub(super) fn give_back(gone: On<Discard, MappingTrial>, mut commands: Commands) {
    restore(gone.entity, &mut commands);
}

/// Restores the original request for a clone, since the trial is not cloned.
pub(super) fn give_to_clones(
    added: On<Add, ReplacedScenario>,
    trials: Query<(), With<MappingTrial>>,
    mut commands: Commands,
) {
    if !trials.contains(added.entity) {
        restore(added.entity, &mut commands);
    }
}

fn restore(entity: Entity, commands: &mut Commands) {
    commands.queue(move |world: &mut World| {
        let Ok(mut root) = world.get_entity_mut(entity) else { return };
        let Some(ReplacedScenario { before, during }) = root.take() else { return };
        if root.get() != during.as_ref() {
            return;
        }
        match before {
            Some(before) => root.insert(before),
            None => root.remove::<EnvironmentScenario>(),
        };
    });
}
