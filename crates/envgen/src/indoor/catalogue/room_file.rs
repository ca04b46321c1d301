//! Rooms as RON.

use ron::extensions::Extensions;

use super::RoomDesign;

/// Reads the text of a `.room.ron` file. It does not check the room; see [`RoomDesign::validate`].
///
/// # Errors
/// Names the line and column of the mistake.
pub fn room_from_ron(text: &str) -> Result<RoomDesign, Box<ron::error::SpannedError>> {
    room_options().from_str(text).map_err(Box::new)
}

/// Returns a room as the text of a `.room.ron` file.
pub fn room_to_ron(room: &RoomDesign) -> String {
    let config = ron::ser::PrettyConfig::default().depth_limit(2);
    room_options().to_string_pretty(room, config).unwrap_or_default()
}

fn room_options() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}
