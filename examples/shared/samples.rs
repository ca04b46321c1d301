//! Anti-aliasing.

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use wgpu_types::DeviceType;

/// Whether the graphics driver renders on the processor.
pub(crate) fn is_software(adapter: &RenderAdapterInfo) -> bool {
    adapter.device_type == DeviceType::Cpu
}

/// Returns the samples per pixel for which a graphics driver is fast enough. A software driver takes
/// ten times as long for four samples in a forest.
pub(crate) fn samples(adapter: &RenderAdapterInfo) -> Msaa {
    if is_software(adapter) { Msaa::Off } else { Msaa::default() }
}
