//! How smooth edges are drawn.

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use wgpu_types::DeviceType;

/// Whether the graphics driver draws on the processor.
pub(crate) fn is_software(adapter: &RenderAdapterInfo) -> bool {
    adapter.device_type == DeviceType::Cpu
}

/// The samples per pixel that a graphics driver is fast enough for: software takes ten times as long for four of them
/// in a forest.
pub(crate) fn samples(adapter: &RenderAdapterInfo) -> Msaa {
    if is_software(adapter) { Msaa::Off } else { Msaa::default() }
}
