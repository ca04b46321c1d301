//! Projects: files with the plan of a world.

use std::collections::BTreeMap;
use std::io;

use quick_xml::Writer;

use super::error::WorldGeneratorError;
use super::library::{HALLWAY, LibraryRoom};
use super::xml::{Element, Flat};
use crate::indoor::blueprint::FloorPlan;
use crate::indoor::catalogue::{Catalogue, SharedRoom};
use crate::indoor::grid::{
    Axis, Cell, Gate, Grid, Opening, Origin, Sides, is_whole, sort_openings,
};
use crate::indoor::placed_room::PlacedRoom;
use crate::indoor::spec::{IndoorSpec, Profile};
use crate::world::Contents;
use crate::xml_text::allowed;

/// The greatest depth and width of a world that is read, in cells.
const MAX_SIZE: u32 = 1024;

/// The settings that are attributes of the root where they are not the default, and what they are in a spec. The tool,
/// in whose files a cell has no size, does not read them.
fn metres(spec: &mut IndoorSpec) -> [(&'static str, &mut f64); 6] {
    [
        ("cell_size", &mut spec.cell_size),
        ("wall_thickness", &mut spec.wall_thickness),
        ("wall_height", &mut spec.wall_height),
        ("doorway", &mut spec.doorway),
        ("doorway_height", &mut spec.doorway_height),
        ("robot_radius", &mut spec.robot_radius),
    ]
}

/// A project that was read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Project {
    /// The world's name.
    pub name: String,
    /// The plan.
    pub plan: FloorPlan,
    /// Number of doors that were left out because they are not in a wall of a room with floor on both sides.
    pub doors_ignored: usize,
    /// Number of elements that are neither rooms nor doors.
    pub elements_ignored: usize,
    /// Number of attributes of the world, its rooms and its doors that mean nothing here.
    pub attributes_ignored: usize,
}

/// Reads a project. Rooms come from the catalogue by name. A room that the catalogue does not have comes from the
/// library, empty and with its size.
///
/// # Errors
/// When the text is not the XML of a project, when a room is unknown, extends beyond the world or overlaps another
/// room, or when a size in metres is not allowed.
pub fn read_project(
    text: &str,
    catalogue: &Catalogue,
    library: &[LibraryRoom],
) -> Result<Project, WorldGeneratorError> {
    let (mut document, root) = Flat::open(text, "world")?;
    let depth = root.number("world", 1, "depth", (1, MAX_SIZE))?;
    let width = root.number("world", 1, "width", (1, MAX_SIZE))?;
    let name = root.get("name").unwrap_or_default().to_owned();
    let mut spec = spec(&root, width, depth)?;
    let settings = metres(&mut spec).map(|(name, _)| name);
    let mut attributes_ignored =
        root.others(&[&["depth", "width", "name"], &settings[..]].concat());
    let mut reading = Reading {
        known: library.iter().map(|room| (room.name.as_str(), room)).collect(),
        catalogue,
        shared: BTreeMap::new(),
        grid: Grid::new(width, depth),
        rooms: Vec::new(),
        count: 0,
    };
    let mut gates = Vec::new();
    let mut elements_ignored = 0;
    while let Some(element) = document.next()? {
        if element.is("room") {
            reading.room(&element)?;
            attributes_ignored += element.others(&["name", "x", "y", "theta"]);
        } else if element.is("door") {
            gates.push(door(&element, gates.len() + 1, depth, width)?);
            attributes_ignored += element.others(&["x", "y", "direction"]);
        } else {
            elements_ignored += 1;
        }
    }
    let Reading { grid, rooms, .. } = reading;
    let doors = gates.len();
    let mut openings: Vec<Opening> = gates
        .into_iter()
        .filter(|&gate| {
            let [[a, _], [b, _]] = gate.cells(&grid);
            a != b && is_whole(&grid, gate) && !(a.is_floor() && b.is_floor())
        })
        .map(|gate| Opening { gate, origin: Origin::Edited })
        .collect();
    let doors_ignored = doors - openings.len();
    sort_openings(&mut openings);
    let plan = FloorPlan {
        spec: Box::new(spec),
        seed: None,
        grid,
        rooms,
        openings,
        draws: None,
        edited: false,
        edits: Vec::new(),
        choice: None,
    };
    Ok(Project { name, plan, doors_ignored, elements_ignored, attributes_ignored })
}

/// Returns the settings of a project.
fn spec(root: &Element, width: u32, height: u32) -> Result<IndoorSpec, WorldGeneratorError> {
    let mut spec = IndoorSpec { width, height, profile: Profile::Thesis, ..Default::default() };
    for (name, value) in metres(&mut spec) {
        *value = root.metres("world", 1, name, *value)?;
    }
    let wrong = spec.check_metres();
    wrong.map_err(|error| {
        let names = metres(&mut spec).map(|(name, _)| name);
        WorldGeneratorError::Attribute {
            element: "world",
            number: 1,
            attribute: names.into_iter().find(|name| error.field == *name).unwrap_or_default(),
            value: error.value,
            allowed: error.allowed,
        }
    })?;
    Ok(spec)
}

struct Reading<'a> {
    known: BTreeMap<&'a str, &'a LibraryRoom>,
    catalogue: &'a Catalogue,
    /// The rooms of the library that the project uses.
    shared: BTreeMap<String, SharedRoom>,
    grid: Grid,
    rooms: Vec<PlacedRoom>,
    count: usize,
}

impl Reading<'_> {
    fn room(&mut self, element: &Element) -> Result<(), WorldGeneratorError> {
        self.count += 1;
        let number = self.count;
        let name = element.text("room", number, "name")?.to_owned();
        let (rows, columns) = (self.grid.height(), self.grid.width());
        let row = element.number("room", number, "x", (0, rows - 1))?;
        let column = element.number("room", number, "y", (0, columns - 1))?;
        let quarters = match element.get("theta") {
            None => 0,
            Some(_) => element.number("room", number, "theta", (0, 3))? as u8,
        };
        if name == HALLWAY {
            if self.grid.at(column, row) != Cell::Solid {
                return Err(WorldGeneratorError::Overlap { number, name, x: row, y: column });
            }
            self.grid.set(column, row, Cell::Hallway);
            return Ok(());
        }
        let room = self.find(&name, number)?;
        let doorways = Sides::default();
        let contents = Contents::AsDesigned;
        let placed = PlacedRoom { room, x: column, y: row, quarters, doorways, contents };
        let (width, height) = placed.size();
        if width > columns - column || height > rows - row {
            return Err(WorldGeneratorError::Outside { number, name });
        }
        for y in row..row + height {
            for x in column..column + width {
                if self.grid.at(x, y) != Cell::Solid {
                    return Err(WorldGeneratorError::Overlap { number, name, x: y, y: x });
                }
            }
        }
        self.grid.fill(column, row, width, height, Cell::Room(self.rooms.len() as u32));
        self.rooms.push(placed);
        Ok(())
    }

    fn find(&mut self, name: &str, number: usize) -> Result<SharedRoom, WorldGeneratorError> {
        if let Some(room) = self.catalogue.get(name).or_else(|| self.shared.get(name)) {
            return Ok(room.clone());
        }
        let unknown = || WorldGeneratorError::UnknownRoom { number, name: name.to_owned() };
        let described = self.known.get(name).ok_or_else(unknown)?;
        let room = SharedRoom::new(described.to_design()).map_err(|_| unknown())?;
        self.shared.insert(name.to_owned(), room.clone());
        Ok(room)
    }
}

fn door(
    element: &Element,
    number: usize,
    depth: u32,
    width: u32,
) -> Result<Gate, WorldGeneratorError> {
    let direction = element.number("door", number, "direction", (0, 1))?;
    // A door in the outer wall at the far end has the number after the last cell's.
    let row = element.number("door", number, "x", (0, depth - direction))?;
    let column = element.number("door", number, "y", (0, width - (1 - direction)))?;
    Ok(match direction {
        0 => Gate { wall: Axis::Horizontal, line: row, at: 2 * column + 1 },
        _ => Gate { wall: Axis::Vertical, line: column, at: 2 * row + 1 },
    })
}

/// Writes a plan as a project.
///
/// # Errors
/// When writing fails.
pub fn write_project(plan: &FloorPlan, name: &str, out: &mut impl io::Write) -> io::Result<()> {
    let grid = plan.grid();
    let mut writer = Writer::new_with_indent(out, b' ', 2);
    let mut world = writer
        .create_element("world")
        .with_attribute(("depth", grid.height().to_string().as_str()))
        .with_attribute(("width", grid.width().to_string().as_str()))
        .with_attribute(("name", &*allowed(name)));
    let (mut spec, mut usual) = (plan.spec().clone(), IndoorSpec::default());
    for ((name, value), (_, usual)) in metres(&mut spec).into_iter().zip(metres(&mut usual)) {
        if *value != *usual {
            world = world.with_attribute((name, value.to_string().as_str()));
        }
    }
    world
        .write_inner_content(|writer| {
            let mut room = |name: &str, x: u32, y: u32, theta: u8| -> io::Result<()> {
                writer
                    .create_element("room")
                    .with_attribute(("name", &*allowed(name)))
                    .with_attribute(("x", y.to_string().as_str()))
                    .with_attribute(("y", x.to_string().as_str()))
                    .with_attribute(("theta", theta.to_string().as_str()))
                    .write_empty()
                    .map(drop)
            };
            for (i, cell) in grid.cells().iter().enumerate() {
                if cell.is_floor() {
                    let (x, y) = grid.position(i);
                    room(HALLWAY, x, y, 0)?;
                }
            }
            for placed in plan.rooms() {
                room(&placed.room.name, placed.x, placed.y, placed.quarters % 4)?;
            }
            for gate in doors(plan) {
                let along = gate.at / 2;
                let (x, y, direction) = match gate.wall {
                    Axis::Horizontal => (gate.line, along, "0"),
                    Axis::Vertical => (along, gate.line, "1"),
                };
                writer
                    .create_element("door")
                    .with_attribute(("x", x.to_string().as_str()))
                    .with_attribute(("y", y.to_string().as_str()))
                    .with_attribute(("direction", direction))
                    .write_empty()?;
            }
            Ok(())
        })
        .map(drop)?;
    writer.into_inner().write_all(b"\n")
}

/// Returns the positions of the openings, sorted and without duplicates. Openings between two cells are moved to
/// the middle of the earlier cell.
fn doors(plan: &FloorPlan) -> Vec<Gate> {
    let mut gates: Vec<Gate> = plan
        .openings()
        .iter()
        .map(|opening| Gate { at: (opening.gate.at - 1) | 1, ..opening.gate })
        .collect();
    gates.sort_unstable();
    gates.dedup();
    gates
}
