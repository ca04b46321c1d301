//! The settings of the drawing in three dimensions.

use bevy::prelude::*;

/// A resource with the settings of the drawing in three dimensions.
///
/// A change affects all worlds at once. The exceptions are visible lamps, smoke, and
/// [`Palette3d`](super::Palette3d), of which each tile or scenario keeps the values at the time when it is
/// spawned.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct Visuals3dSettings {
    /// Whether there are ceilings over rooms and hallways, and lamps under them. Without them the interior of
    /// buildings is visible from above, and some sunlight falls in.
    pub ceilings: bool,
    /// Whether the sun casts shadows.
    pub shadows: bool,
    /// The distance between the lamps of a room in metres, at least 1.
    pub lamp_spacing: f32,
    /// A factor on the brightness of lit rooms and of the open. The default suits a camera with Bevy's
    /// default exposure.
    pub brightness: f32,
    /// The brightness of rooms without lamps, as a fraction of that of lit rooms.
    pub darkness: f32,
    /// Whether cameras get a [`Sky`](super::Sky).
    pub sky: bool,
    /// The distance in metres to the nearest camera up to which trees are drawn with all their triangles.
    /// Beyond it they have less than half of them, and beyond 2.5 times this distance a fifth. All are drawn
    /// if it is infinity, and while a camera is orthographic.
    pub detail_distance: f32,
}

impl Default for Visuals3dSettings {
    fn default() -> Self {
        Visuals3dSettings {
            ceilings: false,
            shadows: true,
            lamp_spacing: 4.0,
            brightness: 1.0,
            darkness: 0.02,
            sky: true,
            detail_distance: 60.0,
        }
    }
}
