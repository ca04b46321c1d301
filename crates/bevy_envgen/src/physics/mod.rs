//! Colliders for the parts of worlds, and for the people and doors of scenarios.
//!
//! Walls, trees, obstacles and closed doorways stop bodies and rays, exactly where [`envgen::raycast`]
//! does. Surfaces, rooms and doorways are sensors, which report the bodies inside them. People and leaves of
//! [`crate::scenario`] are kinematic bodies.

mod collider;
mod moving;
mod setup;

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    ActiveCollisionTypes, ActiveEvents, Collider, CollisionEvent, CollisionGroups, Friction, Group,
    Restitution, Sensor,
};

pub use moving::PersonHit;
pub(crate) use moving::fit_leaves;
pub use setup::TopDownPhysicsPlugin;

use crate::environment::EnvironmentStats;
use crate::part::{Doorway, PartId, PartKind};
use crate::shape::PartShape;
use crate::spawn::{TileSolids, TileSpawned};
use crate::{EnvgenSystems, Schedules};

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
/// A resource for all environments; [`EnvironmentColliders`] is the same for one. Both are read when
/// parts are spawned.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct ColliderSettings {
    /// Whether the solid parts of a tile share one collider.
    pub merge: ColliderMerging,
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

/// The [`ColliderSettings`] of one environment, on its entity.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct EnvironmentColliders(pub ColliderSettings);

/// Adds colliders to the parts of worlds, and bodies to the people and leaves of scenarios.
///
/// Rapier itself is not added: see [`TopDownPhysicsPlugin`]. Without it the colliders have no
/// effect.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenPhysicsPlugin {
    colliders: ColliderSettings,
}

impl EnvgenPhysicsPlugin {
    /// Uses `colliders` instead of the default settings.
    pub fn with_colliders(self, colliders: ColliderSettings) -> Self {
        EnvgenPhysicsPlugin { colliders }
    }
}

impl Plugin for EnvgenPhysicsPlugin {
    fn build(&self, app: &mut App) {
        let main = Schedules::of(app).main;
        app.register_type::<ColliderSettings>()
            .register_type::<EnvironmentColliders>()
            .insert_resource(self.colliders)
            .add_message::<PersonHit>()
            .add_observer(collide)
            .add_observer(moving::embody)
            .add_observer(moving::hang)
            .add_systems(
                main,
                moving::report_hits
                    .after(EnvgenSystems::Notify)
                    .run_if(resource_exists::<Messages<CollisionEvent>>),
            );
    }
}

/// The settings of an environment.
fn settings_of(world: &World, environment: Entity) -> ColliderSettings {
    match world.get::<EnvironmentColliders>(environment) {
        Some(own) => own.0,
        None => world.get_resource::<ColliderSettings>().copied().unwrap_or_default(),
    }
}

/// Adds colliders to the parts of a tile.
fn collide(spawned: On<TileSpawned>, mut commands: Commands) {
    let spawned = spawned.event().clone();
    commands.queue(move |world: &mut World| give_colliders(world, &spawned));
}

fn give_colliders(world: &mut World, spawned: &TileSpawned) {
    // Entities that other observers of the tile have despawned are skipped.
    let (Ok(root), Ok(tile)) =
        (world.get_entity(spawned.environment), world.get_entity(spawned.tile))
    else {
        return;
    };
    let settings = settings_of(world, spawned.environment);
    let solids = root.get::<EnvironmentStats>().and_then(|stats| stats.solids);
    let merge = tile.contains::<TileSolids>()
        || match settings.merge {
            ColliderMerging::Above(most) => solids.is_none_or(|solids| solids > most),
            ColliderMerging::Always => true,
            ColliderMerging::Never => false,
        };
    let kinds: Vec<(Entity, PartKind)> = spawned
        .parts
        .iter()
        .filter_map(|&part| Some((part, world.get::<PartId>(part)?.kind)))
        .collect();
    let of_kind = |is: fn(PartKind) -> bool| -> Vec<Entity> {
        kinds.iter().filter(|(_, kind)| is(*kind)).map(|(part, _)| *part).collect()
    };
    let physical = (
        settings.solid_groups,
        Friction::coefficient(settings.friction),
        Restitution::coefficient(settings.restitution),
    );
    if merge {
        let solid = spawned.placed(world).filter(|(id, ..)| id.kind.is_solid());
        if let Some(collider) = collider::merged(solid.map(|(_, at, shape)| (at, shape))) {
            world.entity_mut(spawned.tile).insert((collider, physical));
        }
    } else {
        let colliders = colliders(world, &of_kind(PartKind::is_solid));
        world.insert_batch(
            colliders.into_iter().map(|(part, collider)| (part, (collider, physical))),
        );
    }
    if settings.sensors {
        let sensing =
            of_kind(|kind| matches!(kind, PartKind::Surface | PartKind::Room | PartKind::Doorway));
        let colliders = colliders(world, &sensing);
        let types = ActiveCollisionTypes::default() | ActiveCollisionTypes::KINEMATIC_STATIC;
        let sensor = (Sensor, ActiveEvents::COLLISION_EVENTS, types, settings.sensor_groups);
        world
            .insert_batch(colliders.into_iter().map(|(part, collider)| (part, (collider, sensor))));
    }
    for doorway in of_kind(|kind| kind == PartKind::Doorway) {
        close(world, doorway, settings.door_groups);
    }
}

/// Fills a doorway that is closed for ever. The collider of the doorway itself is a sensor.
fn close(world: &mut World, doorway: Entity, groups: CollisionGroups) {
    let entity = world.entity(doorway);
    let (Some(part), Some(shape)) = (entity.get::<Doorway>(), entity.get::<PartShape>()) else {
        return;
    };
    let Some(collider) = collider::collider(shape).filter(|_| !part.open) else { return };
    let above = entity.get::<GlobalTransform>().copied().unwrap_or_default();
    let name = Name::new("closed door");
    world.spawn((name, ChildOf(doorway), Transform::IDENTITY, above, collider, groups));
}

/// The colliders of the parts that have an extent.
fn colliders(world: &World, parts: &[Entity]) -> Vec<(Entity, Collider)> {
    let collider = |&part: &Entity| {
        let shape = world.get::<PartShape>(part)?;
        Some((part, collider::collider(shape)?))
    };
    parts.iter().filter_map(collider).collect()
}
