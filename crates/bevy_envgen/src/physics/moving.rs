//! Bodies for the people of scenarios and the leaves of doors.

use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    ActiveEvents, Collider, ColliderDisabled, CollisionEvent, Friction, RigidBody,
};
use envgen::scenario::PERSON_RADIUS;

use super::settings::settings_of;
use crate::part::PartOf;
use crate::scenario::{DoorLeaf, Person, leaf_collider};

/// An event that is triggered on a [`Person`], and written as a message, when a body of rapier starts to
/// touch the person.
#[derive(EntityEvent, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct PersonCollision {
    /// The person.
    pub entity: Entity,
    /// The entity of the collider that touches the person.
    pub collider: Entity,
}

/// Makes a person a kinematic body.
pub(super) fn embody(
    added: On<Add, Person>,
    parts: Query<&PartOf>,
    world: &World,
    mut commands: Commands,
) {
    let Ok(part) = parts.get(added.entity) else { return };
    let settings = settings_of(world, part.0);
    commands.entity(added.entity).try_insert((
        RigidBody::KinematicPositionBased,
        Collider::ball(PERSON_RADIUS as f32),
        ActiveEvents::COLLISION_EVENTS,
        settings.person_groups,
        Friction::coefficient(settings.friction),
    ));
}

/// Makes a leaf a kinematic body.
pub(super) fn hang(
    added: On<Add, DoorLeaf>,
    leaves: Query<(&DoorLeaf, &PartOf)>,
    world: &World,
    mut commands: Commands,
) {
    let Ok((leaf, part)) = leaves.get(added.entity) else { return };
    let settings = settings_of(world, part.0);
    let mut entity = commands.entity(added.entity);
    entity.try_insert((
        RigidBody::KinematicPositionBased,
        leaf_collider(leaf),
        settings.door_groups,
        Friction::coefficient(settings.friction),
    ));
    if leaf.length <= 0.0 {
        entity.try_insert(ColliderDisabled);
    }
}

/// Reports the bodies that touch people.
pub(super) fn report_collisions(
    mut events: MessageReader<CollisionEvent>,
    people: Query<(), With<Person>>,
    mut collisions: MessageWriter<PersonCollision>,
    mut commands: Commands,
) {
    for event in events.read() {
        let CollisionEvent::Started(first, second, flags) = *event else { continue };
        if flags.contains(bevy_rapier2d::rapier::geometry::CollisionEventFlags::SENSOR) {
            continue;
        }
        for (entity, collider) in [(first, second), (second, first)] {
            if people.contains(entity) {
                let collision = PersonCollision { entity, collider };
                collisions.write(collision);
                commands.trigger(collision);
            }
        }
    }
}
