//! A change of a plan by hand, as it is made and as files hold it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::catalogue::SharedRoom;
use super::grid::Gate;
use crate::world::Obstacle;

/// A change of a plan. The provenance of an edited plan lists its changes, as JSON.
///
/// ```
/// use envgen::indoor::{Edit, IndoorSpec, PlanEditor};
/// use envgen::{Blueprint, Seed, Spec};
///
/// let mut editor = PlanEditor::new(IndoorSpec::default().generate(Seed(3))?);
/// editor.apply(Edit::RemoveRoom { room: 0 })?;
/// let world = editor.into_plan().to_world();
/// assert_eq!(world.provenance.edits, [serde_json::json!({"remove_room": {"room": 0}})]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Puts a room with its upper left corner at a cell. It may take solid cells and open areas.
    AddRoom {
        /// The room.
        room: SharedRoom,
        /// Column of its leftmost cells.
        x: u32,
        /// Row of its uppermost cells.
        y: u32,
        /// Quarter turns counter-clockwise.
        quarters: u8,
    },
    /// Moves a room, with those of its doorways that lead somewhere at the new position.
    MoveRoom {
        /// Its index in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Column of its leftmost cells.
        x: u32,
        /// Row of its uppermost cells.
        y: u32,
    },
    /// Turns a room about its upper left corner, with its doorways.
    TurnRoom {
        /// Its index in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Quarter turns counter-clockwise.
        quarters: u8,
    },
    /// Removes a room; its cells become open area, or solid where the spec has no open areas.
    /// The last room takes its index in [`FloorPlan::rooms`](super::FloorPlan::rooms).
    RemoveRoom {
        /// Its index in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
    },
    /// Makes a solid cell or a piece of open area a hallway.
    AddHallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Makes a hallway cell solid.
    RemoveHallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Opens a room's wall.
    OpenDoorway(Gate),
    /// Closes an opening.
    CloseDoorway(Gate),
    /// Puts an object into a room. It may be turned, and touch other objects, but not reach outside of the room.
    AddObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// The object, with its shape in metres in the frame of the world.
        object: Obstacle,
    },
    /// Moves an object inside its room.
    MoveObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Its index in the room's obstacles.
        object: usize,
        /// How far in metres, in the frame of the world.
        by: DVec2,
    },
    /// Turns an object about its middle.
    TurnObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Its index in the room's obstacles.
        object: usize,
        /// The angle in radians, counter-clockwise.
        angle: f64,
    },
    /// Removes an object. Those behind it in the list of the room's obstacles move up.
    RemoveObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Its index in the room's obstacles.
        object: usize,
    },
}
