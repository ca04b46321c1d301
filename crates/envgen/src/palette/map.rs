//! The colours of a robot's map, of errors in it, and of trajectories.

use super::srgb::Srgb;

/// A free cell, as in maps of ROS.
pub const FREE: Srgb = Srgb([254; 3]);
/// An unknown cell, as in maps of ROS.
pub const UNKNOWN: Srgb = Srgb([205; 3]);
/// An occupied cell.
pub const OCCUPIED: Srgb = Srgb([30; 3]);
/// An unknown cell in windows and films, where it is the background.
pub const VIEW_UNKNOWN: Srgb = Srgb::hex(0x8a_8f_98);
/// A free cell in windows and films.
pub const VIEW_FREE: Srgb = Srgb::hex(0xf4_f4_f1);
/// An occupied cell in windows and films.
pub const VIEW_OCCUPIED: Srgb = Srgb::hex(0x1c_1f_26);
/// A wall of the map that the world does not have.
pub const FALSE_WALL: Srgb = Srgb([213, 70, 0]);
/// A wall of the world that the map does not show.
pub const MISSED_WALL: Srgb = Srgb([0, 90, 190]);
/// Ground that the map does not show as free.
pub const NOT_MAPPED: Srgb = Srgb([190, 215, 240]);
/// Ground outside the mappable area.
pub const OUTSIDE: Srgb = Srgb([232, 229, 222]);
/// The true trajectory of a robot.
pub const TRUE_TRAJECTORY: Srgb = Srgb([0, 140, 90]);
/// The trajectory of a robot as estimated by its SLAM.
pub const ESTIMATED_TRAJECTORY: Srgb = Srgb([204, 80, 160]);
