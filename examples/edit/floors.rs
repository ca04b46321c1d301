//! Floors of rooms in the colours of their difficulty, as in pictures of worlds.

use bevy::prelude::*;
use envgen::geometry::Shape;
use envgen::glam::DVec2;
use envgen::palette::{self, Srgb};

use crate::session::Session;

/// Height of the floors: above those of `EnvgenVisualsPlugin`, and below everything on them.
const LAYER: f32 = 0.0155;

/// Fraction of white in the colours, so that marks on the floors are visible.
const PALE: f32 = 0.45;

/// The floor of a room.
#[derive(Component)]
pub(crate) struct Floor;

/// Spawns the floors of the present world.
pub(crate) fn lay(
    session: Res<Session>,
    mut laid: Local<u64>,
    old: Query<Entity, With<Floor>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<ColorMaterial>>,
    mut commands: Commands,
) {
    if *laid == session.revision {
        return;
    }
    *laid = session.revision;
    old.iter().for_each(|floor| commands.entity(floor).despawn());
    let unit = meshes.add(Rectangle::new(1.0, 1.0));
    let world = session.document.world();
    for room in world.rooms.iter().filter(|room| room.difficulty.is_some()) {
        let Shape::Box { center, half_size, heading } = room.shape else { continue };
        let Srgb([red, green, blue]) = palette::room_floor(room.difficulty, room.lit);
        let place = |p: DVec2| (p - session.view.origin()).as_vec2().extend(LAYER);
        commands.spawn((
            Floor,
            Mesh2d(unit.clone()),
            MeshMaterial2d(
                materials.add(Color::srgb_u8(red, green, blue).mix(&Color::WHITE, PALE)),
            ),
            Transform::from_translation(place(center))
                .with_rotation(Quat::from_rotation_z(heading as f32))
                .with_scale((2.0 * half_size).as_vec2().extend(1.0)),
        ));
    }
}
