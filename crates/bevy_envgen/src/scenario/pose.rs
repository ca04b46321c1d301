//! Where people and leaves are in the frame of their environment.

use bevy::prelude::*;
use envgen::scenario::{Leaf, PersonState};

use super::part::DoorLeaf;
use crate::shape::LocalFrame;

/// The pose of a person in the environment's frame.
pub(super) fn person_pose(frame: LocalFrame, person: &PersonState) -> Transform {
    frame.pose(person.position, libm::atan2(person.facing.y, person.facing.x))
}

/// A leaf, and its pose in the frame of its door; without a leaf, it is in the wall.
pub(super) fn leaf_pose(
    frame: LocalFrame,
    door: &Transform,
    leaf: Option<&Leaf>,
) -> (DoorLeaf, Transform) {
    let Some(leaf) = leaf else { return (DoorLeaf { length: 0.0 }, Transform::IDENTITY) };
    let along = leaf.tip - leaf.hinge;
    let mut at = frame.pose(leaf.hinge, libm::atan2(along.y, along.x));
    at.translation -= door.translation;
    (DoorLeaf { length: along.length() as f32 }, at)
}
