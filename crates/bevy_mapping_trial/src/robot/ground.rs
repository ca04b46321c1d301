//! The ground that robots drive on, and the parts that are too dark for lasers.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_envgen::{GroundTruth, SpawnedOrigin};
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::surface_index::{Ground, SurfaceIndex};

use super::laser::LaserScanner;
use super::model::RobotModel;

/// The largest difference in metres between the range to a collider of rapier, in single precision, and to
/// the part itself.
const SAME_HIT: f64 = 0.01;

/// A component with the indexed surfaces of an environment, and its parts that lasers see only from a short
/// distance.
#[derive(Component)]
pub(super) struct GroundIndex {
    surfaces: SurfaceIndex,
    /// The dark parts in the plane of a laser, for each height of a laser.
    dark: Vec<(f64, Option<Raycaster>)>,
}

impl GroundIndex {
    /// Indexes the dark parts in the planes of the robots' lasers.
    fn add_lasers(&mut self, truth: &GroundTruth, robots: &Query<&RobotModel, With<LaserScanner>>) {
        for robot in robots {
            let height = robot.laser_mount.height;
            if self.dark_at(height).is_none() {
                self.dark.push((height, Raycaster::of_dark(truth, height)));
            }
        }
    }

    /// Returns the dark parts in the plane of a laser at a height, or `None` if they are not indexed.
    fn dark_at(&self, height: f64) -> Option<&Option<Raycaster>> {
        let mut at = self.dark.iter().filter(|(known, _)| known.to_bits() == height.to_bits());
        at.next().map(|(_, dark)| dark)
    }
}

/// Indexes the surfaces and dark parts of new worlds.
pub(super) fn index(
    worlds: Query<(Entity, &GroundTruth), Changed<GroundTruth>>,
    gone: Query<Entity, (With<GroundIndex>, Without<GroundTruth>)>,
    mut known: Query<(&GroundTruth, &mut GroundIndex)>,
    robots: Query<&RobotModel, With<LaserScanner>>,
    mut commands: Commands,
) {
    for (entity, truth) in &worlds {
        let mut index = GroundIndex { surfaces: SurfaceIndex::new(truth), dark: Vec::new() };
        index.add_lasers(truth, &robots);
        commands.entity(entity).try_insert(index);
    }
    for (truth, mut index) in &mut known {
        index.add_lasers(truth, &robots);
    }
    for entity in &gone {
        commands.entity(entity).try_remove::<GroundIndex>();
    }
}

/// A system parameter with the ground of all environments.
#[derive(SystemParam)]
pub(super) struct Terrain<'w, 's> {
    worlds: Query<'w, 's, (&'static GroundIndex, &'static SpawnedOrigin, &'static GlobalTransform)>,
}

impl Terrain<'_, '_> {
    /// Returns the ground at a point of rapier's world. Where environments overlap, it has the worst value of
    /// each property.
    pub(super) fn at(&self, p: DVec2) -> Ground {
        self.worlds.iter().fold(Ground::PLAIN, |worst, (index, origin, transform)| {
            let affine = transform.affine().as_daffine3().inverse();
            let local = affine.transform_point3(p.extend(0.0)).truncate() + origin.0;
            worst.worst(index.surfaces.at(local))
        })
    }

    /// Returns whether the surface that rapier's ray hits after `range` metres is too dark to give an echo to
    /// a laser at a height and at a point of rapier's world, in the direction of a unit vector. It does not
    /// use the collider that was hit, since the parts of a tile may share a collider. The scale of the
    /// environment also scales the ranges up to which dark parts are visible.
    pub(super) fn is_unseen(&self, height: f64, p: DVec2, direction: DVec2, range: f64) -> bool {
        self.worlds.iter().any(|(index, origin, transform)| {
            let Some(Some(dark)) = index.dark_at(height) else { return false };
            let affine = transform.affine().as_daffine3().inverse();
            let from = affine.transform_point3(p.extend(0.0)).truncate() + origin.0;
            let along = affine.transform_vector3(direction.extend(0.0)).truncate();
            let range = (range + SAME_HIT) * affine.matrix3.x_axis.length();
            let hit = dark.cast_along(from, along.normalize_or_zero(), range);
            hit.is_some_and(|hit| dark.is_unseen(hit))
        })
    }
}
