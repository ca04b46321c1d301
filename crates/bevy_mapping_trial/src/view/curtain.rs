//! Hides worlds whose trials are drawn, and shows them again.

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_envgen::Tile;
use bevy_envgen::scenario::{Door, Person, Smoke};

/// A filter for what is hidden of a world: its tiles, and the people, doors and smoke of its scenario.
type OfWorld = Or<(With<Tile>, With<Person>, With<Door>, With<Smoke>)>;

/// A component of a hidden part of a world, with the visibility that the part has when the world is shown.
#[derive(Component)]
struct HiddenPart {
    before: Visibility,
}

/// A component of a two-dimensional mesh of a hidden world that three-dimensional cameras may see, with the
/// layers that the mesh has when the world is shown.
#[derive(Component)]
struct HiddenFromAbove {
    before: Option<RenderLayers>,
}

/// A component with what is shown of a world, to which all its parts were set.
#[derive(Component, Clone, Copy, PartialEq, Eq)]
#[component(clone_behavior = Ignore)]
pub(super) struct Shown {
    /// Whether two-dimensional cameras see it.
    pub(super) from_above: bool,
    /// Whether three-dimensional cameras see it.
    pub(super) in_3d: bool,
}

/// A filter for what may have to be hidden or shown: what is new, what has another parent, and what an app has
/// changed of parts and meshes.
type Stirred = Or<(
    Changed<ChildOf>,
    (OfWorld, Changed<Visibility>),
    Or<(Added<Tile>, Added<Person>, Added<Door>, Added<Smoke>)>,
    Added<Mesh2d>,
    (With<Mesh2d>, Changed<RenderLayers>),
)>;

/// A system parameter with the entities whose visibility or layers may have to be set again. Worlds have too many parts
/// to visit all of them in every frame.
#[derive(SystemParam)]
pub(super) struct Changes<'w, 's> {
    stirred: Query<'w, 's, Entity, Stirred>,
    bare: RemovedComponents<'w, 's, RenderLayers>,
    above: Query<'w, 's, &'static ChildOf>,
}

impl Changes<'_, '_> {
    /// Returns what has changed since the last call. Entities may be in it twice.
    pub(super) fn take(&mut self) -> Vec<Entity> {
        self.stirred.iter().chain(self.bare.read()).collect()
    }

    /// Returns the ancestor of an entity that has a parent that `is_root`, or the entity itself, and that parent.
    pub(super) fn root_of(
        &self,
        entity: Entity,
        is_root: impl Fn(Entity) -> bool,
    ) -> Option<(Entity, Entity)> {
        let mut child = entity;
        loop {
            let parent = self.above.get(child).ok()?.parent();
            if is_root(parent) {
                return Some((child, parent));
            }
            child = parent;
        }
    }
}

/// A part of a world.
type Part<'a> = (Entity, &'a Visibility, Has<HiddenPart>);

/// A two-dimensional mesh.
type Flat<'a> = (Entity, Option<&'a RenderLayers>, Has<HiddenFromAbove>);

/// The system parameters that show and hide worlds.
#[derive(SystemParam)]
pub(super) struct Curtain<'w, 's> {
    commands: Commands<'w, 's>,
    parts: Query<'w, 's, Part<'static>, OfWorld>,
    below: Query<'w, 's, &'static Children>,
    flat: Query<'w, 's, Flat<'static>, With<Mesh2d>>,
}

impl Curtain<'_, '_> {
    /// Shows the parts of a world to all cameras, only to three-dimensional cameras, or to none. What an app
    /// sets of a hidden part, except to hide it, applies when the part is shown.
    pub(super) fn set(&mut self, children: &Children, wanted: Shown) {
        for &child in children {
            self.set_below(child, child, wanted);
        }
    }

    /// Does so for an entity and everything below it. `child` is the child of the environment that is above it, or it
    /// itself.
    pub(super) fn set_below(&mut self, child: Entity, changed: Entity, wanted: Shown) {
        let Ok((part, &visibility, is_hidden)) = self.parts.get(child) else { return };
        let Shown { from_above, in_3d } = wanted;
        let is_shown = from_above || in_3d;
        if changed == child {
            let is_done = is_hidden && visibility == Visibility::Hidden;
            if is_shown && is_hidden {
                self.commands.queue(move |world: &mut World| show(world, part));
            } else if !is_shown && !is_done {
                self.commands.queue(move |world: &mut World| hide(world, part));
            }
        } else {
            self.set_mesh(changed, from_above);
        }
        let below: Vec<Entity> = self.below.iter_descendants(changed).collect();
        for mesh in below {
            self.set_mesh(mesh, from_above);
        }
    }

    fn set_mesh(&mut self, entity: Entity, from_above: bool) {
        let Ok((mesh, layers, is_hidden)) = self.flat.get(entity) else { return };
        let is_done = is_hidden && layers == Some(&RenderLayers::none());
        if from_above && is_hidden {
            self.commands.queue(move |world: &mut World| show_from_above(world, mesh));
        } else if !from_above && !is_done {
            self.commands.queue(move |world: &mut World| hide_from_above(world, mesh));
        }
    }
}

fn hide(world: &mut World, part: Entity) {
    let Ok(mut part) = world.get_entity_mut(part) else { return };
    // It may be hidden twice in a frame.
    if let Some(&before) = part.get::<Visibility>()
        && !(part.contains::<HiddenPart>() && before == Visibility::Hidden)
    {
        part.insert((HiddenPart { before }, Visibility::Hidden));
    }
}

fn show(world: &mut World, part: Entity) {
    let Ok(mut part) = world.get_entity_mut(part) else { return };
    let Some(HiddenPart { before }) = part.take() else { return };
    if part.get() == Some(&Visibility::Hidden) {
        part.insert(before);
    }
}

fn hide_from_above(world: &mut World, mesh: Entity) {
    let Ok(mut mesh) = world.get_entity_mut(mesh) else { return };
    let before = mesh.get::<RenderLayers>().cloned();
    if mesh.contains::<HiddenFromAbove>() && before == Some(RenderLayers::none()) {
        return;
    }
    mesh.insert((HiddenFromAbove { before }, RenderLayers::none()));
}

fn show_from_above(world: &mut World, mesh: Entity) {
    let Ok(mut mesh) = world.get_entity_mut(mesh) else { return };
    let Some(HiddenFromAbove { before }) = mesh.take() else { return };
    if mesh.get() != Some(&RenderLayers::none()) {
        return;
    }
    match before {
        Some(before) => mesh.insert(before),
        None => mesh.remove::<RenderLayers>(),
    };
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use bevy::ecs::system::RunSystemOnce;

    use super::*;

    #[test]
    fn nothing_has_changed_in_a_quiet_frame() {
        #[derive(Resource, Default)]
        struct Found(Vec<Entity>);
        let mut app = App::new();
        app.init_resource::<Found>()
            .add_systems(Update, |mut changes: Changes<'_, '_>, mut found: ResMut<Found>| {
                found.0 = changes.take()
            });
        let found = |app: &mut App| {
            app.update();
            let found = std::mem::take(&mut app.world_mut().resource_mut::<Found>().0);
            BTreeSet::from_iter(found)
        };
        let root = app.world_mut().spawn(Visibility::default()).id();
        let tile = app.world_mut().spawn((Visibility::default(), ChildOf(root))).id();
        let mesh = app.world_mut().spawn((Mesh2d::default(), ChildOf(tile))).id();
        assert_eq!(found(&mut app), [tile, mesh].into());
        assert_eq!(found(&mut app), [].into());
        // Only the visibility of parts counts, and the layers of meshes.
        app.world_mut().entity_mut(tile).insert((Visibility::Hidden, RenderLayers::none()));
        app.world_mut().entity_mut(mesh).insert((Visibility::Hidden, RenderLayers::none()));
        assert_eq!(found(&mut app), [mesh].into());
        app.world_mut().entity_mut(mesh).remove::<RenderLayers>();
        assert_eq!(found(&mut app), [mesh].into());
        let root_of = move |changes: Changes<'_, '_>| changes.root_of(mesh, |above| above == root);
        assert_eq!(app.world_mut().run_system_once(root_of).ok(), Some(Some((tile, root))));
    }
}
