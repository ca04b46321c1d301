//! Libraries of rooms.

use std::collections::BTreeSet;
use std::io;

use quick_xml::Writer;

use super::error::WorldGeneratorError;
use super::xml::Flat;
use crate::indoor::catalogue::{Catalogue, HALLWAY_NAME, MAX_ROOM_SIZE, MAX_ROOMS, RoomDesign};
use crate::xml_text::allowed;

/// The name of a piece of hallway.
pub const HALLWAY: &str = HALLWAY_NAME;

/// A room of a library. Its size is known; its contents are in another file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LibraryRoom {
    /// The name.
    pub name: String,
    /// The name of the file that contains the room's shape.
    pub src: String,
    /// Number of rows that it takes.
    pub depth: u32,
    /// Number of columns that it takes.
    pub width: u32,
    /// Number of storeys that it takes.
    pub height: u32,
    /// The group in which the tool lists it.
    pub tag: String,
}

impl LibraryRoom {
    /// Returns a room of this size without contents, with the difficulty 0.
    pub fn to_design(&self) -> RoomDesign {
        RoomDesign::bare(&self.name, self.width, self.depth, 0.0)
    }
}

/// Reads a library.
///
/// # Errors
/// When the text is not the XML of a library, or when two rooms have the same name.
pub fn read_library(text: &str) -> Result<Vec<LibraryRoom>, WorldGeneratorError> {
    let (mut document, _) = Flat::open(text, "roomList")?;
    let mut names = BTreeSet::new();
    let mut rooms = Vec::new();
    while let Some(element) = document.next()? {
        if !element.is("room") {
            continue;
        }
        let number = rooms.len() + 1;
        let name = element.text("room", number, "name")?.to_owned();
        let size = element.text("room", number, "size")?;
        let wrong = || WorldGeneratorError::Attribute {
            element: "room",
            number,
            attribute: "size",
            value: format!("`{size}`"),
            allowed: format!("depth, width, height: three whole numbers from 1 to {MAX_ROOM_SIZE}"),
        };
        let sizes: Vec<u32> = size
            .split(',')
            .map(|part| part.trim().parse().ok())
            .collect::<Option<_>>()
            .ok_or_else(wrong)?;
        let &[depth, width, height] = sizes.as_slice() else { return Err(wrong()) };
        if sizes.iter().any(|size| !(1..=MAX_ROOM_SIZE).contains(size)) {
            return Err(wrong());
        }
        if !names.insert(name.clone()) {
            return Err(WorldGeneratorError::Duplicate(name));
        }
        if rooms.len() == MAX_ROOMS {
            return Err(WorldGeneratorError::Attribute {
                element: "roomList",
                number: 1,
                attribute: "room",
                value: "more rooms".to_owned(),
                allowed: format!("at most {MAX_ROOMS}"),
            });
        }
        let text = |attribute| element.get(attribute).unwrap_or_default().to_owned();
        rooms.push(LibraryRoom { name, src: text("src"), depth, width, height, tag: text("tag") });
    }
    Ok(rooms)
}

/// Writes the rooms of a catalogue, and the hallway, as a library. The file of each room is its name with the
/// ending `.room.ron`; its tag is `envgen`.
///
/// # Errors
/// When writing fails.
pub fn write_library(catalogue: &Catalogue, out: &mut impl io::Write) -> io::Result<()> {
    let mut writer = Writer::new_with_indent(out, b' ', 2);
    writer
        .create_element("roomList")
        .write_inner_content(|writer| {
            let hallway = (HALLWAY, 1, 1);
            let rooms = catalogue.rooms().iter().map(|r| (r.name.as_str(), r.height, r.width));
            for (name, depth, width) in std::iter::once(hallway).chain(rooms) {
                let src = format!("{}.room.ron", name.replace(' ', "_"));
                writer
                    .create_element("room")
                    .with_attribute(("name", &*allowed(name)))
                    .with_attribute(("src", &*allowed(&src)))
                    .with_attribute(("size", format!("{depth}, {width}, 1").as_str()))
                    .with_attribute(("tag", "envgen"))
                    .write_empty()?;
            }
            Ok(())
        })
        .map(drop)?;
    writer.into_inner().write_all(b"\n")
}
