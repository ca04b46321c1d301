//! Robots and mapping trials in headless Bevy apps that are used as users use them.

#[cfg(feature = "debug")]
mod debug;
#[cfg(feature = "debug")]
#[path = "../../../bevy_envgen/tests/shared/gizmos.rs"]
mod gizmos;
mod heights;
#[cfg(feature = "debug")]
#[path = "../../../bevy_envgen/tests/shared/inspector.rs"]
mod inspector;
mod losses;
mod other_plugins;
mod robot;
mod scenario;
mod trial;
#[cfg(feature = "render")]
mod view;
#[cfg(feature = "render")]
mod view_despawned;
#[cfg(feature = "render")]
mod view_several;
