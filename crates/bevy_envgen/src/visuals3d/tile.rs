//! What a mesh of a tile is made of, and whether it is shown.

use bevy::prelude::*;

use super::finish::Finish;
use super::settings::Visuals3dSettings;

/// A mesh of a tile, on a child of the [`Tile`](crate::Tile): all its bodies of one finish, or a tree's trunk or
/// crown.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct TileMesh {
    /// What it is made of.
    pub finish: Finish,
}

/// Whether meshes of a finish are shown.
pub(super) fn is_shown(finish: Finish, settings: &Visuals3dSettings) -> Visibility {
    let is_above = matches!(finish, Finish::Ceiling | Finish::Lamp);
    if is_above && !settings.ceilings { Visibility::Hidden } else { Visibility::Inherited }
}

/// Shows ceilings as the settings say.
pub(super) fn show_ceilings(
    settings: Res<Visuals3dSettings>,
    mut meshes: Query<(&TileMesh, &mut Visibility)>,
) {
    if settings.is_changed() {
        for (mesh, mut visibility) in &mut meshes {
            visibility.set_if_neq(is_shown(mesh.finish, &settings));
        }
    }
}
