//! The poses of people and leaves in the frame of their environment.

use bevy::prelude::*;
use envgen::scenario::{Leaf, PersonState, ScenarioState};

use super::part::DoorLeaf;
use crate::shape::LocalFrame;

/// Returns the pose of a person in the frame of the environment.
pub(super) fn person_pose(frame: LocalFrame, person: &PersonState) -> Transform {
    frame.pose(person.position, libm::atan2(person.facing.y, person.facing.x))
}

/// Returns the leaves of a door, with their poses in the frame of the door. A leaf that has slid into the
/// wall has no length, and its pose is where it comes out again.
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
