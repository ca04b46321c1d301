//! The colliders of leaves, which follow the length of those that slide.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{Collider, ColliderDisabled};

use super::part::DoorLeaf;

/// A leaf as a line, without thickness as in the scenario.
pub(crate) fn leaf_collider(leaf: &DoorLeaf) -> Collider {
    // One that is in the wall keeps a length, since rapier refuses to have none.
    Collider::segment(Vec2::ZERO, Vec2::X * leaf.length.max(0.01))
}

/// The leaves whose length may have changed.
type Slid = (Entity, &'static DoorLeaf, &'static mut Collider, Has<ColliderDisabled>);

/// Changes the colliders of sliding leaves.
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
