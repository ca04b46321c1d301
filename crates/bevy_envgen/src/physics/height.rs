//! The heights of colliders, which decide what they collide with.

use std::collections::BTreeMap;

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier2d::pipeline::{BevyPhysicsHooks, PairFilterContextView};
use bevy_rapier2d::prelude::{ActiveHooks, Collider};
use bevy_rapier2d::rapier::prelude::SolverFlags;

use super::collider;
use crate::height::HeightRange;
use crate::part::PartId;
use crate::shape::PartShape;

/// Rapier's hooks that [`TopDownPhysicsPlugin`](super::TopDownPhysicsPlugin) uses: colliders whose
/// [`HeightRange`]s do not overlap do not collide.
///
/// An app that adds `RapierPhysicsPlugin` itself can use them as its type parameter, or call them from hooks
/// of its own. Without them, colliders collide at every height.
#[derive(SystemParam)]
pub struct HeightHooks<'w, 's> {
    heights: Query<'w, 's, &'static HeightRange>,
}

impl BevyPhysicsHooks for HeightHooks<'_, '_> {
    fn filter_contact_pair(&self, pair: PairFilterContextView<'_>) -> Option<SolverFlags> {
        // The height of a body is on its own entity, or on the entity of one of its colliders.
        let height = |collider: Entity, body: Option<Entity>| {
            self.heights.get(collider).or_else(|_| self.heights.get(body.unwrap_or(collider))).ok()
        };
        let first = height(pair.collider1(), pair.rigid_body1());
        let second = height(pair.collider2(), pair.rigid_body2());
        let meet = first.zip(second).is_none_or(|(first, second)| first.overlaps(*second));
        meet.then_some(SolverFlags::COMPUTE_IMPULSES)
    }
}

/// Returns whether a part of this height may pass others. Those that extend upwards from the floor all
/// collide with each other.
fn passes(height: &HeightRange) -> bool {
    height.bottom > 0.0 || height.top <= 0.0
}

/// Makes rapier call [`HeightHooks`] for entities above or below the floor.
pub(super) fn filter_contacts(
    inserted: On<Insert, HeightRange>,
    heights: Query<(&HeightRange, Option<&ActiveHooks>)>,
    mut commands: Commands,
) {
    if let Ok((height, hooks)) = heights.get(inserted.entity)
        && passes(height)
    {
        filter(&mut commands, inserted.entity, hooks);
    }
}

/// A filter for entities that may have become descendants of an entity with a height. Parts do not change
/// their parents.
type Moved = (Or<(Added<Collider>, Changed<ChildOf>)>, Without<PartId>);

/// Does the same when a height changes, and for the colliders below a body that has the height, since rapier
/// reads from colliders which hooks to call.
pub(super) fn filter_bodies(
    changed: Query<(Entity, &HeightRange), Changed<HeightRange>>,
    moved: Query<Entity, Moved>,
    heights: Query<&HeightRange>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    colliders: Query<Option<&ActiveHooks>, With<Collider>>,
    mut commands: Commands,
) {
    let may_pass = |entity: Entity| heights.get(entity).is_ok_and(passes);
    let changed = changed.iter().filter(|(_, height)| passes(height)).map(|(entity, _)| entity);
    let moved = moved
        .iter()
        .filter(|&entity| may_pass(entity) || parents.iter_ancestors(entity).any(may_pass));
    let below = |entity: Entity| std::iter::once(entity).chain(children.iter_descendants(entity));
    for collider in changed.chain(moved).flat_map(below) {
        if let Ok(hooks) = colliders.get(collider) {
            filter(&mut commands, collider, hooks);
        }
    }
}

fn filter(commands: &mut Commands, collider: Entity, hooks: Option<&ActiveHooks>) {
    let hooks = hooks.copied().unwrap_or_default();
    if !hooks.contains(ActiveHooks::FILTER_CONTACT_PAIRS) {
        commands.entity(collider).try_insert(hooks | ActiveHooks::FILTER_CONTACT_PAIRS);
    }
}

/// The colliders of a merged tile.
pub(super) struct Merged {
    /// The collider of the parts that count as infinitely high.
    pub(super) full: Option<Collider>,
    /// The colliders of all other parts, one for each range of heights.
    pub(super) others: Vec<(HeightRange, Collider)>,
}

/// Merges parts. Those that are above the floor, or less than `full` metres high, get separate colliders.
pub(super) fn merge<'a>(
    parts: impl Iterator<Item = (&'a Transform, &'a PartShape, Option<HeightRange>)>,
    full: f64,
) -> Merged {
    let mut whole = Vec::new();
    let mut others: BTreeMap<[u64; 2], (HeightRange, Vec<_>)> = BTreeMap::new();
    for (at, shape, height) in parts {
        match height {
            Some(height) if height.bottom > 0.0 || height.top < full => {
                let key = [height.bottom, height.top].map(f64::to_bits);
                others.entry(key).or_insert((height, Vec::new())).1.push((at, shape));
            }
            _ => whole.push((at, shape)),
        }
    }
    let merged = |(height, parts): (HeightRange, Vec<_>)| {
        Some((height, collider::merged(parts.into_iter())?))
    };
    Merged {
        full: collider::merged(whole.into_iter()),
        others: others.into_values().filter_map(merged).collect(),
    }
}
