//! The ground that robots drive on.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_envgen::{Environment, GroundTruth};
use envgen::glam::DVec2;
use envgen::surface_index::{Ground, SurfaceIndex};

/// The indexed surfaces of an environment.
#[derive(Component)]
pub(super) struct GroundIndex(SurfaceIndex);

/// Indexes the surfaces of new worlds.
pub(super) fn index(
    worlds: Query<(Entity, &GroundTruth), Changed<GroundTruth>>,
    gone: Query<Entity, (With<GroundIndex>, Without<GroundTruth>)>,
    mut commands: Commands,
) {
    for (entity, truth) in &worlds {
        commands.entity(entity).try_insert(GroundIndex(SurfaceIndex::new(truth)));
    }
    for entity in &gone {
        commands.entity(entity).try_remove::<GroundIndex>();
    }
}

/// The ground of all environments.
#[derive(SystemParam)]
pub(super) struct Terrain<'w, 's> {
    worlds: Query<'w, 's, (&'static GroundIndex, &'static Environment, &'static GlobalTransform)>,
}

impl Terrain<'_, '_> {
    /// The ground at a point of rapier's world; where environments overlap, the worst value of each
    /// property.
    pub(super) fn at(&self, p: DVec2) -> Ground {
        self.worlds.iter().fold(Ground::PLAIN, |worst, (index, environment, transform)| {
            let affine = transform.affine().as_daffine3().inverse();
            let local = affine.transform_point3(p.extend(0.0)).truncate() + environment.origin;
            let ground = index.0.at(local);
            Ground {
                speed: worst.speed.min(ground.speed),
                odometry_noise: worst.odometry_noise.max(ground.odometry_noise),
                water: worst.water || ground.water,
            }
        })
    }
}
