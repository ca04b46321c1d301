//! The render layers of minimaps.

use bevy::camera::visibility::RenderLayers;

/// The render layer that only minimaps show: arrows at the robots' positions.
pub const MINIMAP_LAYER: usize = 30;

/// The render layers of a minimap's camera: everything that other cameras see, and arrows at the
/// robots.
pub fn minimap_layers() -> RenderLayers {
    RenderLayers::from_layers(&[0, MINIMAP_LAYER])
}
