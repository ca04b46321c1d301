//! Manual changes of a plan, as they are applied and as files contain them.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::catalogue::SharedRoom;
use super::grid::Gate;
use crate::world::Obstacle;

/// A change of a plan. The provenance of an edited plan lists its changes as JSON.
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
    /// Places a room with its upper left corner at a cell. The room may take solid cells and open areas.
    AddRoom {
        /// The room.
        room: SharedRoom,
        /// Column of its leftmost cells.
        x: u32,
        /// Row of its uppermost cells.
        y: u32,
        /// Number of quarter turns counter-clockwise.
        quarters: u8,
    },
    /// Moves a room, with those of its doorways that lead somewhere at the new position.
    MoveRoom {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// New column of its leftmost cells.
        x: u32,
        /// New row of its uppermost cells.
        y: u32,
    },
    /// Turns a room about its upper left corner, with its doorways.
    TurnRoom {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Number of quarter turns counter-clockwise.
        quarters: u8,
    },
    /// Removes a room. Its cells become open area, or solid if the spec has no open areas. The last room takes its
    /// index in [`FloorPlan::rooms`](super::FloorPlan::rooms).
    RemoveRoom {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
    },
    /// Turns a solid cell or a cell of open area into a hallway.
    AddHallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Turns a hallway cell into a solid cell.
    RemoveHallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Opens a doorway in a room's wall.
    OpenDoorway(Gate),
    /// Closes a doorway.
    CloseDoorway(Gate),
    /// Adds an object to a room. It may be rotated and may touch other objects, but must not extend outside the room.
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
        /// Index of the object in the room's obstacles.
        object: usize,
        /// Displacement in metres, in the frame of the world.
        by: DVec2,
    },
    /// Turns an object about its middle.
    TurnObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Index of the object in the room's obstacles.
        object: usize,
        /// The angle in radians, counter-clockwise.
        angle: f64,
    },
    /// Removes an object. The indices of the objects behind it in the room's obstacles decrease by one.
    RemoveObject {
        /// Index of the room in [`FloorPlan::rooms`](super::FloorPlan::rooms).
        room: usize,
        /// Index of the object in the room's obstacles.
        object: usize,
    },
}
