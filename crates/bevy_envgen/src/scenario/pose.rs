//! Where people and leaves are in the frame of their environment.

use bevy::prelude::*;
use envgen::scenario::{Leaf, PersonState, ScenarioState};

use super::part::DoorLeaf;
use crate::shape::LocalFrame;

/// The pose of a person in the environment's frame.
pub(super) fn person_pose(frame: LocalFrame, person: &PersonState) -> Transform {
    frame.pose(person.position, libm::atan2(person.facing.y, person.facing.x))
}

/// The leaves of a door, and their poses in its frame. One that is in the wall has no length, and waits where it comes
/// out.
pub(super) fn leaf_poses(
    frame: LocalFrame,
    door: &Transform,
    state: &ScenarioState,
    index: usize,
) -> impl Iterator<Item = (DoorLeaf, Transform)> {
    let place = move |leaf: Leaf| {
        let along = leaf.tip - leaf.hinge;
        let mut at = frame.pose(leaf.hinge, libm::atan2(along.y, along.x));
        at.translation -= door.translation;
        (DoorLeaf { length: along.length() as f32 }, at)
    };
    let closed = state.leaves_at(index, 0.0).map(place);
    let mut now = state.leaves(index).map(place);
    closed.map(move |(_, at)| now.next().unwrap_or((DoorLeaf { length: 0.0 }, at)))
}
