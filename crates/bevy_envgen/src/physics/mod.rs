//! Rapier colliders for the parts of worlds, and for the people and doors of scenarios.
//!
//! Walls, trees, obstacles and closed doorways stop bodies and rays, exactly as in [`envgen::raycast`].
//! Surfaces, rooms and doorways are sensors, which report the bodies inside them. People and leaves of
//! [`crate::scenario`] are kinematic bodies.
//!
//! Rapier's physics is two-dimensional. The colliders of parts have a [`HeightRange`], which decides which
//! bodies they stop; see [`HeightHooks`].

mod clones;
mod collider;
mod height;
mod moving;
mod settings;
mod setup;
mod turned;

use bevy::ecs::message::MessageRegistry;
use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    ActiveCollisionTypes, ActiveEvents, Collider, CollisionEvent, CollisionGroups,
    ContactForceEvent, Friction, MassModifiedMessage, PhysicsSet, Restitution, Sensor,
};

pub use height::HeightHooks;
pub use moving::PersonCollision;
pub use settings::{
    ColliderMerging, ColliderSettings, DOOR_GROUP, EnvironmentColliders, PERSON_GROUP,
    SENSOR_GROUP, SOLID_GROUP,
};
pub use setup::TopDownPhysicsPlugin;

use self::settings::settings_of;
use crate::environment::EnvironmentStats;
use crate::height::HeightRange;
use crate::overhead::{Overhead, find_overhead};
use crate::part::{Doorway, PartId, PartKind};
use crate::shape::PartShape;
use crate::spawn::{Tile, TileSolids, TileSpawned};
use crate::systems::{EnvgenSchedules, EnvgenSystems};

/// Adds colliders to the parts of worlds, and bodies to the people and leaves of scenarios.
///
/// It does not add rapier itself; see [`TopDownPhysicsPlugin`]. Without rapier the colliders have no effect.
/// By default it uses the collider settings that the app already has, if any.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvgenPhysicsPlugin {
    colliders: Option<ColliderSettings>,
}

impl EnvgenPhysicsPlugin {
    /// Inserts `colliders` as the settings, replacing those that the app already has.
    pub fn with_colliders(self, colliders: ColliderSettings) -> Self {
        EnvgenPhysicsPlugin { colliders: Some(colliders) }
    }
}

impl Plugin for EnvgenPhysicsPlugin {
    fn build(&self, app: &mut App) {
        let main = EnvgenSchedules::of(app).main;
        match self.colliders {
            Some(colliders) => app.insert_resource(colliders),
            None => app.init_resource::<ColliderSettings>(),
        };
        app.register_type::<ColliderSettings>()
            .register_type::<EnvironmentColliders>()
            .add_message::<PersonCollision>()
            .add_observer(collide)
            .add_observer(collide_with_own)
            .add_observer(collide_with_shared)
            .add_observer(clones::lose_body)
            .add_observer(clones::lose_collider)
            .add_observer(height::filter_contacts)
            .add_observer(moving::embody)
            .add_observer(moving::hang)
            // An app may have both in the same schedule.
            .configure_sets(main, PhysicsSet::SyncBackend.after(EnvgenSystems::Notify))
            // Both are before physics, which may run in either schedule.
            .add_systems(FixedPreUpdate, height::filter_bodies)
            .add_systems(
                main,
                (
                    height::filter_bodies
                        .after(EnvgenSystems::Notify)
                        .before(PhysicsSet::SyncBackend),
                    moving::report_collisions
                        .after(EnvgenSystems::Notify)
                        .after(PhysicsSet::Writeback)
                        .run_if(resource_exists::<Messages<CollisionEvent>>),
                ),
            );
    }

    fn finish(&self, app: &mut App) {
        keep_short::<CollisionEvent>(app);
        keep_short::<ContactForceEvent>(app);
        keep_short::<MassModifiedMessage>(app);
    }
}

/// Makes Bevy clear old messages of a type that rapier has, which rapier itself does not do. Other plugins may have
/// done it already, and a message that is registered twice would be cleared too soon.
fn keep_short<M: Message>(app: &mut App) {
    if app.world().contains_resource::<Messages<M>>() {
        MessageRegistry::deregister_messages::<M>(app.world_mut());
        app.add_message::<M>();
    }
}

/// Adds colliders to the parts of a tile.
fn collide(spawned: On<TileSpawned>, mut commands: Commands) {
    let spawned = spawned.event().clone();
    commands.queue(move |world: &mut World| give_colliders(world, &spawned));
}

/// A marker component of colliders of parts that have an entity of their own.
#[derive(Component)]
struct PartCollider;

/// Replaces the colliders of an environment by those of its new settings.
fn collide_with_own(inserted: On<Insert, EnvironmentColliders>, mut commands: Commands) {
    let environment = inserted.entity;
    commands.queue(move |world: &mut World| collide_again(world, environment));
}

/// Replaces the colliders of an environment whose own settings are removed by those of the resource.
fn collide_with_shared(removed: On<Remove, EnvironmentColliders>, mut commands: Commands) {
    let environment = removed.entity;
    commands.queue(move |world: &mut World| {
        // The environment may be despawned, or have other settings already.
        if world.get::<EnvironmentColliders>(environment).is_none() {
            collide_again(world, environment);
        }
    });
}

/// Replaces the colliders of an environment, if it still exists.
fn collide_again(world: &mut World, environment: Entity) {
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
        // Rapier does not notice a collider that is removed and inserted at once, so existing colliders
        // are overwritten.
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
}

/// The components that an entity has because of its collider.
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
        if let (Some(collider), Ok(mut tile)) = (full, world.get_entity_mut(spawned.tile)) {
            tile.insert((collider, physical));
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
    if settings.lintels {
        let has_lintel = |kind| kind == PartKind::Doorway;
        find_overhead(world, spawned.environment, &spawned.parts, has_lintel);
    }
    for doorway in of_kind(|kind| kind == PartKind::Doorway) {
        close(world, doorway, settings.door_groups);
        let index = world.get::<PartId>(doorway).map_or(0, |part| part.index as usize);
        let known = world.get::<Overhead>(spawned.environment).filter(|_| settings.lintels);
        let lintel = known.and_then(|known| *known.lintels.get(index)?);
        let shape = world.get::<PartShape>(doorway).and_then(collider::collider);
        if let (Some(lintel), Some(collider)) = (lintel, shape) {
            let height = HeightRange::from(lintel);
            add_below(world, doorway, "lintel", (collider, height, settings.solid_groups));
        }
    }
}

/// Fills a doorway that is permanently closed. The collider of the doorway itself is a sensor.
fn close(world: &mut World, doorway: Entity, groups: CollisionGroups) {
    let Ok(entity) = world.get_entity(doorway) else { return };
    let (Some(part), Some(shape)) = (entity.get::<Doorway>(), entity.get::<PartShape>()) else {
        return;
    };
    let Some(collider) = collider::collider(shape).filter(|_| !part.open) else { return };
    match entity.get::<HeightRange>().copied() {
        Some(height) => add_below(world, doorway, "closed door", (collider, height, groups)),
        None => add_below(world, doorway, "closed door", (collider, groups)),
    }
}

/// Spawns a collider with an entity of its own, at the pose of `parent`, unless an observer of another
/// collider has despawned `parent`.
fn add_below(world: &mut World, parent: Entity, name: &'static str, collider: impl Bundle) {
    if world.get_entity(parent).is_err() {
        return;
    }
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

/// Returns the colliders of the parts that have an extent.
fn colliders(world: &World, parts: &[Entity]) -> Vec<(Entity, Collider)> {
    let collider = |&part: &Entity| {
        let shape = world.get::<PartShape>(part)?;
        Some((part, collider::collider(shape)?))
    };
    parts.iter().filter_map(collider).collect()
}
