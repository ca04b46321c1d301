//! The colliders of the leaves of doors, which have the length of the visible part of sliding leaves.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{Collider, ColliderDisabled};

use super::part::DoorLeaf;

/// Returns the collider of a leaf: a line, since leaves have no thickness in the scenario.
pub(crate) fn leaf_collider(leaf: &DoorLeaf) -> Collider {
    // A leaf that has slid into the wall keeps a short length, since rapier rejects segments without a
    // length.
    Collider::segment(Vec2::ZERO, Vec2::X * leaf.length.max(0.01))
}

/// The leaves whose length may have changed.
type Slid = (Entity, &'static DoorLeaf, &'static mut Collider, Has<ColliderDisabled>);

/// Fits the colliders of sliding leaves to their length.
pub(super) fn fit_leaves(mut leaves: Query<Slid, Changed<DoorLeaf>>, mut commands: Commands) {
    for (entity, leaf, mut shape, is_disabled) in &mut leaves {
        *shape = leaf_collider(leaf);
        let is_gone = leaf.length <= 0.0;
        if is_gone && !is_disabled {
            commands.entity(entity).try_insert(ColliderDisabled);
        } else if is_disabled && !is_gone {
            commands.entity(entity).try_remove::<ColliderDisabled>();
        }
    }
}
