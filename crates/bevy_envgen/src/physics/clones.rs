//! Gives clones of entities with a collider or a body a collider or a body of their own.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    RapierColliderHandle, RapierContextColliders, RapierRigidBodyHandle, RapierRigidBodySet,
};

/// Removes from a clone the handle of the original's collider, which the clone would otherwise move. Rapier
/// then adds another collider.
pub(super) fn lose_collider(
    added: On<Add, RapierColliderHandle>,
    contexts: Query<&RapierContextColliders>,
    mut commands: Commands,
) {
    // Rapier adds a collider to its map before it inserts the handle on the entity.
    if !contexts.iter().any(|known| known.entity2collider().contains_key(&added.entity)) {
        commands.entity(added.entity).try_remove::<RapierColliderHandle>();
    }
}

/// Does the same for bodies.
pub(super) fn lose_body(
    added: On<Add, RapierRigidBodyHandle>,
    contexts: Query<&RapierRigidBodySet>,
    mut commands: Commands,
) {
    if !contexts.iter().any(|known| known.entity2body().contains_key(&added.entity)) {
        commands.entity(added.entity).try_remove::<RapierRigidBodyHandle>();
    }
}
