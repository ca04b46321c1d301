//! The colours of a robot's map, of what is wrong in it, and of trajectories.

use super::srgb::Srgb;

/// A free cell, as in maps of ROS.
pub const FREE: Srgb = Srgb([254; 3]);
/// A cell of which nothing is known, as in maps of ROS.
pub const UNKNOWN: Srgb = Srgb([205; 3]);
/// An occupied cell.
pub const OCCUPIED: Srgb = Srgb([30; 3]);
/// As [`UNKNOWN`] in windows and films, where it is the background.
pub const VIEW_UNKNOWN: Srgb = Srgb::hex(0x8a_8f_98);
/// As [`FREE`] in windows and films.
pub const VIEW_FREE: Srgb = Srgb::hex(0xf4_f4_f1);
/// As [`OCCUPIED`] in windows and films.
pub const VIEW_OCCUPIED: Srgb = Srgb::hex(0x1c_1f_26);
/// A wall of the map that the world does not have.
pub const FALSE_WALL: Srgb = Srgb([213, 70, 0]);
/// A wall of the world that the map does not show.
pub const MISSED_WALL: Srgb = Srgb([0, 90, 190]);
/// Ground that the map does not show as free.
pub const NOT_MAPPED: Srgb = Srgb([190, 215, 240]);
/// Where there is nothing to map.
pub const OUTSIDE: Srgb = Srgb([232, 229, 222]);
/// Where a robot was.
pub const TRUE_TRAJECTORY: Srgb = Srgb([0, 140, 90]);
/// Where a robot believes that it was.
pub const ESTIMATED_TRAJECTORY: Srgb = Srgb([204, 80, 160]);
