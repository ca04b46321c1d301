//! What is drawn, and how bright.

use bevy::prelude::*;

/// What is drawn in three dimensions, and how bright. A change affects all worlds at once, except that lamps which are
/// seen, smoke, and [`Palette3d`](super::Palette3d), are those of the time when a tile or a scenario is spawned.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Debug, PartialEq, Clone)]
pub struct Visuals3dSettings {
    /// Ceilings over rooms and hallways, and lamps under them. Without them one sees into buildings from above, and
    /// some of the sun falls in.
    pub ceilings: bool,
    /// Whether the sun casts shadows.
    pub shadows: bool,
    /// Distance between the lamps of a room in metres, at least 1.
    pub lamp_spacing: f32,
    /// Brightness of lit rooms and of the open, as a factor. The default suits a camera with Bevy's default
    /// exposure.
    pub brightness: f32,
    /// Light in rooms without lamps, as a share of that of lit rooms.
    pub darkness: f32,
    /// Whether cameras get a [`Sky`](super::Sky).
    pub sky: bool,
    /// Distance in metres to the nearest camera up to which trees are drawn with all their triangles. Beyond it they
    /// have less than half of them, and beyond 2.5 times as far a fifth. With infinity, and while a camera is
    /// orthographic, all are drawn.
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
