//! Colliders for the parts of worlds, and for the people and doors of scenarios.
//!
//! Walls, trees, obstacles and closed doorways stop bodies and rays, exactly where [`envgen::raycast`]
//! does. Surfaces, rooms and doorways are sensors, which report the bodies inside them. People and leaves of
//! [`crate::scenario`] are kinematic bodies.
//!
//! Rapier is flat. The colliders of parts have a [`HeightRange`], which decides what they stop:
//! see [`HeightHooks`].

mod collider;
mod height;
mod moving;
mod setup;

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    ActiveCollisionTypes, ActiveEvents, Collider, CollisionEvent, CollisionGroups, Friction, Group,
    Restitution, Sensor,
};

pub use height::HeightHooks;
pub use moving::PersonHit;
pub use setup::TopDownPhysicsPlugin;

use crate::environment::{EnvironmentStats, GroundTruth};
use crate::height::HeightRange;
use crate::part::{Doorway, PartId, PartKind};
use crate::shape::PartShape;
use crate::spawn::{Tile, TileSolids, TileSpawned};
use crate::{EnvgenSchedules, EnvgenSystems};

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
    /// Merged: one compound on the entity of the [`Tile`]. In a large world it costs
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
    /// everything. Lower ones, and those above the floor, share a collider with others of their
    /// [`HeightRange`] alone. At least as high as the highest laser, so that it sees what it should.
    pub full_height: f64,
    /// Whether there are colliders over doorways, which only robots that are higher than a door need. A ray
    /// whose filter does not ask for their [`HeightRange`] does not pass the doorway.
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
        let main = EnvgenSchedules::of(app).main;
        app.register_type::<ColliderSettings>()
            .register_type::<EnvironmentColliders>()
            .insert_resource(self.colliders)
            .add_message::<PersonHit>()
            .add_observer(collide)
            .add_observer(collide_again)
            .add_observer(height::filter_contacts)
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

/// A collider of parts that has an entity of its own.
#[derive(Component)]
struct PartCollider;

/// Replaces the colliders of an environment.
fn collide_again(inserted: On<Insert, EnvironmentColliders>, mut commands: Commands) {
    let environment = inserted.entity;
    commands.queue(move |world: &mut World| {
        let children = |world: &World, parent: Entity| -> Vec<Entity> {
            world.get::<Children>(parent).map_or_else(Vec::new, |children| children.to_vec())
        };
        let tiles = children(world, environment).into_iter();
        let tiles: Vec<_> = tiles.filter(|&tile| world.get::<Tile>(tile).is_some()).collect();
        for tile in tiles {
            let below = children(world, tile);
            let parts: Vec<_> =
                below.iter().copied().filter(|&part| world.get::<PartId>(part).is_some()).collect();
            let own: Vec<_> = parts.iter().flat_map(|&part| children(world, part)).collect();
            for entity in below.into_iter().chain(own) {
                if world.get::<PartCollider>(entity).is_some() {
                    world.despawn(entity);
                }
            }
            // Rapier does not notice a collider that goes and comes at once: those that stay are overwritten.
            let had = parts.iter().copied().chain([tile]);
            let had: Vec<_> = had.filter(|&e| world.get::<Collider>(e).is_some()).collect();
            let before = world.increment_change_tick();
            give_colliders(world, &TileSpawned { environment, tile, parts });
            let now = world.increment_change_tick();
            for entity in had {
                let collider = world.entity(entity).get_ref::<Collider>();
                let is_new = |new: Ref<'_, Collider>| new.last_changed().is_newer_than(before, now);
                if !collider.is_some_and(is_new) {
                    world.entity_mut(entity).remove::<OfCollider>();
                }
            }
        }
    });
}

/// What the entity of a collider has because of it.
type OfCollider =
    (Collider, CollisionGroups, Friction, Restitution, Sensor, ActiveEvents, ActiveCollisionTypes);

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
        let height::Merged { full, others } =
            height::merge(spawned.solids(world), settings.full_height);
        if let Some(collider) = full {
            world.entity_mut(spawned.tile).insert((collider, physical));
        }
        for (height, collider) in others {
            add_below(world, spawned.tile, "solids", (collider, height, physical));
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
    let lintels = lintels(world, spawned.environment, settings);
    for doorway in of_kind(|kind| kind == PartKind::Doorway) {
        close(world, doorway, settings.door_groups);
        let index = world.get::<PartId>(doorway).map_or(0, |part| part.index as usize);
        let shape = world.get::<PartShape>(doorway).and_then(collider::collider);
        if let (Some(Some(lintel)), Some(collider)) = (lintels.get(index), shape) {
            let height = HeightRange::from(*lintel);
            add_below(world, doorway, "lintel", (collider, height, settings.solid_groups));
        }
    }
}

/// Fills a doorway that is closed for ever. The collider of the doorway itself is a sensor.
fn close(world: &mut World, doorway: Entity, groups: CollisionGroups) {
    let entity = world.entity(doorway);
    let (Some(part), Some(shape)) = (entity.get::<Doorway>(), entity.get::<PartShape>()) else {
        return;
    };
    let Some(collider) = collider::collider(shape).filter(|_| !part.open) else { return };
    match entity.get::<HeightRange>().copied() {
        Some(height) => add_below(world, doorway, "closed door", (collider, height, groups)),
        None => add_below(world, doorway, "closed door", (collider, groups)),
    }
}

/// Adds a collider of its own, at the pose of `parent`.
fn add_below(world: &mut World, parent: Entity, name: &'static str, collider: impl Bundle) {
    let above = world.get::<GlobalTransform>(parent).copied().unwrap_or_default();
    world.spawn((
        Name::new(name),
        PartCollider,
        ChildOf(parent),
        Transform::IDENTITY,
        above,
        collider,
    ));
}

/// The lintels of the doorways of an environment, where asked.
fn lintels(
    world: &World,
    environment: Entity,
    settings: ColliderSettings,
) -> Vec<Option<envgen::world::Extent>> {
    let truth = world.get::<GroundTruth>(environment).filter(|_| settings.lintels);
    truth.map_or_else(Vec::new, |truth| truth.lintels())
}

/// The colliders of the parts that have an extent.
fn colliders(world: &World, parts: &[Entity]) -> Vec<(Entity, Collider)> {
    let collider = |&part: &Entity| {
        let shape = world.get::<PartShape>(part)?;
        Some((part, collider::collider(shape)?))
    };
    parts.iter().filter_map(collider).collect()
}
