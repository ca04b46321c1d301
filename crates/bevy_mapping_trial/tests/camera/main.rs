//! The cameras of robots, drawn without a window. Needs a graphics card or Mesa's software Vulkan.

mod background;
mod exact;
mod recording;
mod refusals;
