//! The settings of the colliders of parts, and their collision groups.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{CollisionGroups, Group};

/// The collision group of people.
pub const PERSON_GROUP: Group = Group::GROUP_29;
/// The collision group of walls, trees and obstacles.
pub const SOLID_GROUP: Group = Group::GROUP_30;
/// The collision group of leaves, and of doorways that are permanently closed.
pub const DOOR_GROUP: Group = Group::GROUP_31;
/// The collision group of surfaces, rooms and doorways.
pub const SENSOR_GROUP: Group = Group::GROUP_32;

/// Whether the solid parts of a tile share one collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum ColliderMerging {
    /// Parts are merged in worlds with more solid parts than this, and in endless worlds.
    Above(usize),
    /// Parts are merged into one compound collider on the entity of the [`Tile`](crate::Tile). In a large
    /// world this takes rapier a fraction of the time of single colliders.
    Always,
    /// Every part has a collider of its own, so that a ray or a contact identifies the part. Parts that are
    /// data of their tile are merged even so; see [`SolidStorage::TileData`](crate::SolidStorage::TileData).
    Never,
}

impl Default for ColliderMerging {
    fn default() -> Self {
        ColliderMerging::Above(1000)
    }
}

/// A resource with the settings of the colliders of all environments.
///
/// [`EnvironmentColliders`] has the settings of a single environment. The settings are read when parts are
/// spawned.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct ColliderSettings {
    /// Whether the solid parts of a tile share one collider.
    pub merge: ColliderMerging,
    /// The height in metres, in the world's own scale, from which a solid on the floor counts as infinitely
    /// high in a merged tile. Lower solids, and those above the floor, share a collider only with others of
    /// the same [`HeightRange`](crate::HeightRange). It should be at least the height of the highest laser,
    /// so that the laser detects the right solids.
    pub full_height: f64,
    /// Whether the lintels over doorways have colliders, which only robots that are higher than a door need.
    /// A ray does not pass such a doorway, unless its filter checks the [`HeightRange`](crate::HeightRange).
    pub lintels: bool,
    /// Whether surfaces, rooms and doorways have sensors.
    pub sensors: bool,
    /// The coefficient of friction of walls, trees, obstacles, people and leaves.
    pub friction: f32,
    /// The coefficient of restitution of walls, trees and obstacles. It is 0 for no bounce.
    pub restitution: f32,
    /// The collision groups of walls, trees and obstacles.
    pub solid_groups: CollisionGroups,
    /// The collision groups of leaves, and of doorways that are permanently closed.
    pub door_groups: CollisionGroups,
    /// The collision groups of people.
    pub person_groups: CollisionGroups,
    /// The collision groups of sensors. By default sensors detect everything except the parts of the world.
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

/// A component with the [`ColliderSettings`] of a single environment, on its entity. To change it, insert another;
/// without it, the resource applies. Inserting or removing it replaces the colliders of the existing parts, and all
/// components of these colliders.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Deref, Reflect)]
#[component(immutable)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct EnvironmentColliders(pub ColliderSettings);

/// Returns the settings of an environment.
pub(super) fn settings_of(world: &World, environment: Entity) -> ColliderSettings {
    match world.get::<EnvironmentColliders>(environment) {
        Some(own) => own.0,
        None => world.get_resource::<ColliderSettings>().copied().unwrap_or_default(),
    }
}
