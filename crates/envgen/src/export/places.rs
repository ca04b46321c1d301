//! The start, the goal and the victims.

use crate::World;
use crate::geometry::Pose;

/// Returns the start, the goal and the victims, with their names: `start`, `goal`, `victim_0` and so on.
pub(super) fn places(world: &World) -> impl Iterator<Item = (String, Pose)> + '_ {
    let ends = [("start", world.start), ("goal", world.goal)];
    let ends = ends.into_iter().filter_map(|(name, pose)| Some((name.to_owned(), pose?)));
    let victims = world.victims.iter().enumerate();
    ends.chain(victims.map(|(i, &pose)| (format!("victim_{i}"), pose)))
}
