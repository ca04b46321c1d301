//! Tests of whole trials and their parts, in one program so that they share all cores.

mod drive;
mod empty_room;
mod exact;
mod golden;
mod loop_closing;
mod navigation;
mod policies;
#[cfg(feature = "experiment")]
mod proof;
mod robots;
mod ros_maps;
mod scenario;
mod slam;
mod slam_bands;
mod water;
mod wheel_errors;
