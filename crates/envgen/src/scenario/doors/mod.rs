//! Doors: leaves that turn or slide, and the control of their motion.

mod door;
mod free_space;
mod leaf;
mod motion;
mod place;

pub use door::{Door, DoorKind};
pub(super) use leaf::DoorShape;
pub use leaf::Leaf;
pub(super) use motion::{Bodies, DoorClock, LEAF_GAP};
pub use motion::{DoorCommand, DoorState, GivenDoorCommand};
pub(super) use place::place_doors;
