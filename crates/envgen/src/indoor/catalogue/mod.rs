//! Catalogues: the rooms that a map may contain.

mod builtin;
pub(super) mod design;
mod folder;
mod room_file;
mod room_list;
mod shared_room;

#[cfg(feature = "usarsim")]
pub(super) use design::HALLWAY_NAME;
pub use design::{MAX_ROOM_PARTS, MAX_ROOM_SIZE, RoomDesign, RoomError};
pub use folder::FolderError;
pub use room_file::{room_from_ron, room_to_ron};
pub use room_list::{Catalogue, CatalogueError, MAX_ROOMS};
pub use shared_room::SharedRoom;

#[cfg(test)]
mod tests;
