//! The start and the goal.

use crate::World;
use crate::geometry::Pose;

/// Returns the start and the goal, with their names.
pub(super) fn places(world: &World) -> impl Iterator<Item = (&'static str, Pose)> {
    let places = [("start", world.start), ("goal", world.goal)];
    places.into_iter().filter_map(|(name, pose)| Some((name, pose?)))
}
