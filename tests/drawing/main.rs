//! What is drawn without a window. Needs a graphics card, or Mesa's software Vulkan:
//! `cargo test --features render --test drawing`.

mod film;
mod picture;
mod studio;
