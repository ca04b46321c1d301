//! The render layers of minimaps.

use bevy::camera::visibility::RenderLayers;

/// The render layer that only minimaps show. It has the arrows at the positions of the robots.
pub const MINIMAP_LAYER: usize = 30;

/// Returns the render layers of the camera of a minimap: everything that other cameras see, and the arrows at
/// the positions of the robots.
pub fn minimap_layers() -> RenderLayers {
    RenderLayers::from_layers(&[0, MINIMAP_LAYER])
}
