//! How parts become colliders, and the groups that these are in.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{CollisionGroups, Group};

/// The collision group of people.
pub const PERSON_GROUP: Group = Group::GROUP_29;
/// The collision group of walls, trees and obstacles.
pub const SOLID_GROUP: Group = Group::GROUP_30;
/// The collision group of leaves, and of doorways that are closed for ever.
pub const DOOR_GROUP: Group = Group::GROUP_31;
/// The collision group of surfaces, rooms and doorways.
pub const SENSOR_GROUP: Group = Group::GROUP_32;

/// Whether the solid parts of a tile share one collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum ColliderMerging {
    /// Merged in worlds with more solid parts than this, and in endless ones.
    Above(usize),
    /// Merged: one compound on the entity of the [`Tile`](crate::Tile). In a large world it costs
    /// rapier a fraction of single colliders.
    Always,
    /// Every part has a collider of its own, so that a ray or a contact identifies the part. Parts
    /// that are data are merged all the same: see
    /// [`SolidStorage::TileData`](crate::SolidStorage::TileData).
    Never,
}

impl Default for ColliderMerging {
    fn default() -> Self {
        ColliderMerging::Above(1000)
    }
}

/// How the parts of an environment become colliders.
///
/// A resource for all environments; [`EnvironmentColliders`] is the same for one. It is read when parts are
/// spawned.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct ColliderSettings {
    /// Whether the solid parts of a tile share one collider.
    pub merge: ColliderMerging,
    /// Solids of a merged tile that are on the floor and at least this many metres high count as high as
    /// everything, in metres of the world, whatever the environment's scale. Lower ones, and those above the floor,
    /// share a collider with others of their [`HeightRange`](crate::HeightRange) alone. At least as high as the
    /// highest laser, so that it sees what it should.
    pub full_height: f64,
    /// Whether there are colliders over doorways, which only robots that are higher than a door need. A ray
    /// whose filter does not ask for their [`HeightRange`](crate::HeightRange) does not pass the doorway.
    pub lintels: bool,
    /// Whether surfaces, rooms and doorways get sensors.
    pub sensors: bool,
    /// Coefficient of friction of walls, trees, obstacles, people and leaves.
    pub friction: f32,
    /// Coefficient of restitution of walls, trees and obstacles, 0 for no bounce.
    pub restitution: f32,
    /// Collision groups of walls, trees and obstacles.
    pub solid_groups: CollisionGroups,
    /// Collision groups of leaves, and of doorways that are closed for ever.
    pub door_groups: CollisionGroups,
    /// Collision groups of people.
    pub person_groups: CollisionGroups,
    /// Collision groups of sensors, which by default detect everything but the world's own parts.
    pub sensor_groups: CollisionGroups,
}

fn solid_groups() -> CollisionGroups {
    CollisionGroups::new(SOLID_GROUP, Group::ALL)
}

fn door_groups() -> CollisionGroups {
    CollisionGroups::new(DOOR_GROUP, Group::ALL)
}

fn person_groups() -> CollisionGroups {
    CollisionGroups::new(PERSON_GROUP, Group::ALL)
}

fn sensor_groups() -> CollisionGroups {
    CollisionGroups::new(SENSOR_GROUP, !(SOLID_GROUP | DOOR_GROUP | SENSOR_GROUP))
}

impl Default for ColliderSettings {
    fn default() -> Self {
        ColliderSettings {
            merge: ColliderMerging::default(),
            full_height: 0.5,
            lintels: false,
            sensors: true,
            friction: 0.5,
            restitution: 0.0,
            solid_groups: solid_groups(),
            door_groups: door_groups(),
            person_groups: person_groups(),
            sensor_groups: sensor_groups(),
        }
    }
}

/// The [`ColliderSettings`] of one environment, on its entity. Inserting it replaces the colliders of the parts that
/// are there, and all that is of colliders on their entities.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct EnvironmentColliders(pub ColliderSettings);

/// The settings of an environment.
pub(super) fn settings_of(world: &World, environment: Entity) -> ColliderSettings {
    match world.get::<EnvironmentColliders>(environment) {
        Some(own) => own.0,
        None => world.get_resource::<ColliderSettings>().copied().unwrap_or_default(),
    }
}
