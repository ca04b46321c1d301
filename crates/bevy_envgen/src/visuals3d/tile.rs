//! The finish of the meshes of tiles, and their visibility.

use bevy::prelude::*;

use super::finish::Finish;
use super::settings::Visuals3dSettings;

/// A component of a mesh of a tile, on a child of the [`Tile`](crate::Tile): all bodies of one finish, or the
/// trunk or the crown of a tree.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct TileMesh {
    /// The finish of the mesh.
    pub finish: Finish,
}

/// Returns the visibility of the meshes of a finish.
pub(super) fn is_shown(finish: Finish, settings: &Visuals3dSettings) -> Visibility {
    let is_above = matches!(finish, Finish::Ceiling | Finish::Lamp);
    if is_above && !settings.ceilings { Visibility::Hidden } else { Visibility::Inherited }
}

/// Shows or hides ceilings as the settings say.
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
