//! Clones of what has a collider or a body. They get their own.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    RapierColliderHandle, RapierContextColliders, RapierRigidBodyHandle, RapierRigidBodySet,
};

/// Takes from a clone the collider of what it was cloned from, which it would move: rapier then adds another.
pub(super) fn lose_collider(
    added: On<Add, RapierColliderHandle>,
    contexts: Query<&RapierContextColliders>,
    mut commands: Commands,
) {
    // Rapier knows its own before their entities do.
    if !contexts.iter().any(|known| known.entity2collider().contains_key(&added.entity)) {
        commands.entity(added.entity).try_remove::<RapierColliderHandle>();
    }
}

/// The same for bodies.
pub(super) fn lose_body(
    added: On<Add, RapierRigidBodyHandle>,
    contexts: Query<&RapierRigidBodySet>,
    mut commands: Commands,
) {
    if !contexts.iter().any(|known| known.entity2body().contains_key(&added.entity)) {
        commands.entity(added.entity).try_remove::<RapierRigidBodyHandle>();
    }
}
