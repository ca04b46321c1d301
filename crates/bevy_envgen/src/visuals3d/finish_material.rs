//! The materials of finishes.

use std::collections::BTreeMap;

use bevy::math::Affine2;
use bevy::prelude::*;

use super::finish::Finish;

impl Finish {
    fn material(self) -> StandardMaterial {
        let (roughness, reflectance) = match self {
            Finish::Ground | Finish::Bark | Finish::Leaves => (1.0, 0.1),
            Finish::Wall | Finish::Ceiling => (0.95, 0.2),
            Finish::Floor => (0.7, 0.35),
            Finish::Plain => (0.65, 0.4),
            Finish::Metal => (0.4, 0.6),
            Finish::Water => (0.1, 0.6),
            Finish::Lamp | Finish::Mark => (1.0, 0.0),
        };
        StandardMaterial {
            perceptual_roughness: roughness,
            reflectance,
            unlit: matches!(self, Finish::Lamp | Finish::Mark),
            alpha_mode: if self == Finish::Water { AlphaMode::Blend } else { AlphaMode::Opaque },
            ..default()
        }
    }

    /// Returns the material of the finish with its texture.
    pub(super) fn textured(self, world: &mut World) -> StandardMaterial {
        let side = self.texture_side().unwrap_or(1.0);
        let texture = self.texture().zip(world.get_resource_mut::<Assets<Image>>());
        StandardMaterial {
            base_color_texture: texture.map(|(image, mut images)| images.add(image)),
            uv_transform: Affine2::from_scale(Vec2::splat(1.0 / side)),
            ..self.material()
        }
    }
}

/// A resource with the materials used so far, which all environments share.
#[derive(Resource, Default)]
pub(super) struct Finishes(BTreeMap<Finish, Handle<StandardMaterial>>);

/// Returns the material of a finish, or `None` in apps that do not draw.
pub(super) fn material(world: &mut World, finish: Finish) -> Option<Handle<StandardMaterial>> {
    if let Some(known) = world.resource::<Finishes>().0.get(&finish) {
        return Some(known.clone());
    }
    let material = finish.textured(world);
    let handle = world.get_resource_mut::<Assets<StandardMaterial>>()?.add(material);
    world.resource_mut::<Finishes>().0.insert(finish, handle.clone());
    Some(handle)
}

/// Returns whether the app has the assets that meshes need.
pub(super) fn can_draw(world: &World) -> bool {
    world.contains_resource::<Assets<Mesh>>()
        && world.contains_resource::<Assets<Image>>()
        && world.contains_resource::<Assets<StandardMaterial>>()
}
