//! The files of the World Generator for `USARSim` (version 4.0, 2011), the tool that Zwennes' thesis extended:
//! projects and libraries of rooms, as XML.
//!
//! A project's root is `world` (`depth`, `width`, `name`). Its children are `room` (`name`, `x`, `y`, `theta` in
//! quarter turns) and `door` (`x`, `y`, `direction`: 0 between the cells (x - 1, y) and (x, y), 1 between
//! (x, y - 1) and (x, y)). x counts the depth, in rows from north to south, and y the width. A hallway is a room called
//! `hallway` of one cell. A library's root is `roomList`; its `room`s have `name`, `src`, `size` ("depth, width,
//! height", in cells) and `tag`.
//!
//! The root also has the settings in metres that are not the default: `cell_size`, `wall_thickness`, `wall_height`,
//! `doorway`, `doorway_height` and `robot_radius`. They are no attributes of the tool, whose cells have no size.
//!
//! The files cannot represent everything: open areas become hallways, doorways between two cells move to the middle
//! of a cell, and difficulties and contents remain in the catalogue.

mod error;
mod library;
mod project;
mod xml;

pub use error::{MAX_TEXT, WorldGeneratorError};
pub use library::{HALLWAY, LibraryRoom, read_library, write_library};
pub use project::{Project, read_project, write_project};

#[cfg(test)]
mod tests;
