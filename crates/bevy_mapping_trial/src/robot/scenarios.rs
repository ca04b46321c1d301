//! What the lasers of robots detect of scenarios.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_envgen::SpawnedOrigin;
use bevy_envgen::scenario::{DoorLeaf, Person, ScenarioRun};
use mapping_trial::lidar::{Rays, ScenarioSight};

/// A filter for the bodies of people and leaves.
type Moving = Or<(With<Person>, With<DoorLeaf>)>;

/// A system parameter with the scenarios of all environments.
#[derive(SystemParam)]
pub(super) struct Scenarios<'w, 's> {
    runs: Query<'w, 's, (&'static ScenarioRun, &'static SpawnedOrigin, &'static GlobalTransform)>,
    moving: Query<'w, 's, (), Moving>,
}

impl Scenarios<'_, '_> {
    /// Returns whether an entity is a person or a leaf.
    pub(super) fn moves(&self, entity: Entity) -> bool {
        self.moving.contains(entity)
    }

    /// Changes the exact ranges of a scan, whose rays are in the frame of rapier's world: the rays end at the
    /// leaves and people of all scenarios, and then in their smoke. Returns the beams that read 0.
    pub(super) fn look(
        &self,
        sight: &mut ScenarioSight,
        (robot, tick): (u64, u64),
        rays: &Rays<'_>,
        ranges: &mut [f64],
    ) -> Vec<usize> {
        let mut zero = Vec::new();
        self.look_into_each(rays, ranges, |run, rays, ranges| {
            ScenarioSight::meet(run.now(), rays, ranges);
        });
        // Bodies behind smoke that has ended a ray are not detected.
        self.look_into_each(rays, ranges, |run, rays, ranges| {
            zero.extend(sight.look_through_smoke(run.now(), (robot, tick), rays, ranges));
        });
        zero
    }

    /// Calls `look` for each scenario, with rays and ranges in the frame of its world.
    fn look_into_each(
        &self,
        rays: &Rays<'_>,
        ranges: &mut [f64],
        mut look: impl FnMut(&ScenarioRun, &Rays<'_>, &mut [f64]),
    ) {
        for (run, origin, transform) in &self.runs {
            let affine = transform.affine().as_daffine3().inverse();
            let scale = affine.matrix3.x_axis.length();
            let from = affine.transform_point3(rays.from.extend(0.0)).truncate();
            let directions: Vec<_> = rays
                .directions
                .iter()
                .map(|along| affine.transform_vector3(along.extend(0.0)).truncate() / scale)
                .collect();
            let rays = Rays {
                from: from + origin.0,
                directions: &directions,
                max_range: rays.max_range * scale,
            };
            ranges.iter_mut().for_each(|range| *range *= scale);
            look(run, &rays, ranges);
            ranges.iter_mut().for_each(|range| *range /= scale);
        }
    }
}
