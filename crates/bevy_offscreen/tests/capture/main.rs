//! Tests of pictures and films. With the feature `render` they include what is drawn without a window, which
//! needs a graphics card or Mesa's software Vulkan.

mod film;
mod picture;
#[cfg(feature = "render")]
mod pipelines;
#[cfg(feature = "render")]
mod studio;
