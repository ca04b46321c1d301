//! What is over the doorways and rooms of a world, which is computed from all its walls.

use bevy::prelude::*;
use envgen::world::Extent;

use crate::environment::GroundTruth;
use crate::part::{PartId, PartKind};

/// A component with the lintels and the height of the ceilings of an environment's world. It is computed once, since
/// a streamed world has many tiles.
#[derive(Component)]
pub(crate) struct Overhead {
    pub(crate) lintels: Vec<Option<Extent>>,
    #[cfg(feature = "render3d")]
    pub(crate) wall_top: f64,
}

/// Computes what is over a world, if `parts` have one of a kind that needs it, unless it is known.
pub(crate) fn find_overhead(
    world: &mut World,
    environment: Entity,
    parts: &[Entity],
    needs_it: impl Fn(PartKind) -> bool,
) {
    let is_below = |&part: &Entity| world.get::<PartId>(part).is_some_and(|id| needs_it(id.kind));
    let Some(truth) = world.get::<GroundTruth>(environment) else { return };
    if world.get::<Overhead>(environment).is_some() || !parts.iter().any(is_below) {
        return;
    }
    let overhead = Overhead {
        lintels: truth.lintels(),
        #[cfg(feature = "render3d")]
        wall_top: truth.wall_top(),
    };
    world.entity_mut(environment).insert(overhead);
}

/// Removes the component when the world is removed.
pub(crate) fn forget_overhead(gone: On<Discard, GroundTruth>, mut commands: Commands) {
    commands.entity(gone.entity).try_remove::<Overhead>();
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use envgen::indoor::IndoorSpec;
    use envgen::{Seed, WorldSpec};

    use super::*;

    #[test]
    fn it_is_computed_once_and_only_for_tiles_that_need_it() {
        let mut app = App::new();
        app.add_observer(forget_overhead);
        let world = app.world_mut();
        let truth = |seed| {
            let spec = WorldSpec::from(IndoorSpec::default());
            GroundTruth(Arc::new(spec.generate(Seed(seed)).unwrap().to_world()))
        };
        let root = world.spawn(truth(1)).id();
        let [wall, door] =
            [PartKind::Wall, PartKind::Doorway].map(|kind| world.spawn(PartId::new(kind, 0)).id());
        let is_door = |kind| kind == PartKind::Doorway;
        let at = |world: &World| world.get::<Overhead>(root).map(|known| known.lintels.as_ptr());
        find_overhead(world, root, &[wall], is_door);
        assert_eq!(at(world), None);
        find_overhead(world, root, &[wall, door], is_door);
        let first = at(world);
        assert!(first.is_some());
        find_overhead(world, root, &[door], is_door);
        assert_eq!(at(world), first);
        // Another world.
        world.entity_mut(root).insert(truth(2));
        assert_eq!(at(world), None);
        find_overhead(world, root, &[door], is_door);
        let lintels = world.get::<GroundTruth>(root).map(|truth| truth.lintels());
        assert_eq!(world.get::<Overhead>(root).map(|known| &known.lintels), lintels.as_ref());
    }
}
