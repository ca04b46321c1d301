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
    pub(super) fn set(&mut self, children: &Children, from_above: bool, in_3d: bool) {
        let is_shown = from_above || in_3d;
        for &child in children {
            let Ok((part, &visibility, is_hidden)) = self.parts.get(child) else { continue };
            let is_done = is_hidden && visibility == Visibility::Hidden;
            if is_shown && is_hidden {
                self.commands.queue(move |world: &mut World| show(world, part));
            } else if !is_shown && !is_done {
                self.commands.queue(move |world: &mut World| hide(world, part));
            }
            for below in self.below.iter_descendants(child) {
                let Ok((mesh, layers, is_hidden)) = self.flat.get(below) else { continue };
                let is_done = is_hidden && layers == Some(&RenderLayers::none());
                if from_above && is_hidden {
                    self.commands.queue(move |world: &mut World| show_from_above(world, mesh));
                } else if !from_above && !is_done {
                    self.commands.queue(move |world: &mut World| hide_from_above(world, mesh));
                }
            }
        }
    }
}

fn hide(world: &mut World, part: Entity) {
    let Ok(mut part) = world.get_entity_mut(part) else { return };
    if let Some(&before) = part.get::<Visibility>() {
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
