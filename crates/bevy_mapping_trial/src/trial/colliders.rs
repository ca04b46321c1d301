//! The colliders that a trial needs, in place of those of its environment.

use bevy::prelude::*;
use bevy_envgen::GroundTruth;
use bevy_envgen::physics::{ColliderSettings, EnvironmentColliders};
use envgen::world::Extent;
use mapping_trial::robot::Robot;

use super::component::{MappingTrial, State};

/// A component with the colliders that a trial has replaced, on the same entity. Clones hold it, so that
/// their colliders can be restored.
#[derive(Component, Clone, Copy)]
pub(super) struct ReplacedColliders {
    before: Option<EnvironmentColliders>,
    during: EnvironmentColliders,
}

/// A trial and the colliders of its environment.
type Needing = (
    Entity,
    &'static MappingTrial,
    &'static GroundTruth,
    Option<&'static EnvironmentColliders>,
    Option<&'static ReplacedColliders>,
);

/// A filter for trials whose colliders may have to be replaced.
type Renewed = Or<(Changed<MappingTrial>, Changed<EnvironmentColliders>)>;

/// Replaces the colliders of trials that have begun by those that they need, also after an app has inserted
/// others or removed them.
pub(super) fn replace(
    trials: Query<Needing, Renewed>,
    settings: Option<Res<ColliderSettings>>,
    mut commands: Commands,
) {
    for (entity, trial, truth, own, replaced) in &trials {
        let (State::Warming(run) | State::Running(run) | State::Over(run)) = &trial.state else {
            continue;
        };
        let found = own.map(|own| own.0).or(settings.as_deref().copied()).unwrap_or_default();
        let Some(wanted) = colliders_for(found, &run.trial.settings().body, truth) else {
            continue;
        };
        let during = EnvironmentColliders(wanted);
        let before = match replaced {
            Some(replaced) if own == Some(&replaced.during) => replaced.before,
            _ => own.copied(),
        };
        commands.entity(entity).insert((during, ReplacedColliders { before, during }));
    }
}

/// Makes [`replace`] visit a trial whose colliders an app has removed, which no filter of queries finds.
pub(super) fn notice_removal(
    removed: On<Remove, EnvironmentColliders>,
    mut trials: Query<&mut MappingTrial>,
) {
    if let Ok(mut trial) = trials.get_mut(removed.entity) {
        trial.set_changed();
    }
}

/// Restores the colliders of an environment when its trial is removed.
pub(super) fn give_back(gone: On<Discard, MappingTrial>, mut commands: Commands) {
    restore(gone.entity, &mut commands);
}

/// Restores the original colliders for a clone, since the trial is not cloned.
pub(super) fn give_to_clones(
    added: On<Add, ReplacedColliders>,
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
        let Some(ReplacedColliders { before, during }) = root.take() else { return };
        if root.get() != Some(&during) {
            return;
        }
        match before {
            Some(before) => root.insert(before),
            None => root.remove::<EnvironmentColliders>(),
        };
    });
}

/// Returns settings of colliders that stop a robot, and are detected by its laser, exactly where the parts of
/// the world are, or `None` if `settings` already do this.
fn colliders_for(
    settings: ColliderSettings,
    body: &Robot,
    world: &envgen::World,
) -> Option<ColliderSettings> {
    let laser = body.laser_mount.height;
    let is_met = |lintel: Extent| {
        lintel.contains(laser) || body.extent().is_ok_and(|body| body.overlaps(lintel))
    };
    let wanted = ColliderSettings {
        full_height: settings.full_height.max(laser),
        lintels: settings.lintels || world.lintels().into_iter().flatten().any(is_met),
        ..settings
    };
    (wanted != settings).then_some(wanted)
}
