//! Rooms placed on a plan.

use super::catalogue::SharedRoom;
use super::dimensions::Dimensions;
use super::grid::{Axis, Gate, Side, Sides};
use super::interior::Port;
use crate::world::Contents;

/// A room placed on a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedRoom {
    /// The room, as it was designed.
    pub room: SharedRoom,
    /// Column of its leftmost cells.
    pub x: u32,
    /// Row of its uppermost cells.
    pub y: u32,
    /// Number of quarter turns counter-clockwise.
    pub quarters: u8,
    /// Sides for which a doorway was drawn.
    pub doorways: Sides,
    /// Which of its contents remain. In the profile `guaranteed`, contents that block drawn doorways are removed,
    /// and all contents if nothing else makes a place reachable. Mazes replace the contents.
    pub contents: Contents,
}

impl PlacedRoom {
    /// Returns the numbers of columns and rows that the room takes.
    pub fn size(&self) -> (u32, u32) {
        match self.quarters % 2 {
            0 => (self.room.width, self.room.height),
            _ => (self.room.height, self.room.width),
        }
    }

    /// Returns the number of cells along a side.
    pub fn side_length(&self, side: Side) -> u32 {
        let (width, height) = self.size();
        match side {
            Side::North | Side::South => width,
            Side::East | Side::West => height,
        }
    }

    /// Returns the position of an opening in a side, `at` half cells from its left or upper end.
    pub fn gate(&self, side: Side, at: u32) -> Gate {
        let (width, height) = self.size();
        match side {
            Side::North => Gate { wall: Axis::Horizontal, line: self.y, at: 2 * self.x + at },
            Side::South => {
                Gate { wall: Axis::Horizontal, line: self.y + height, at: 2 * self.x + at }
            }
            Side::West => Gate { wall: Axis::Vertical, line: self.x, at: 2 * self.y + at },
            Side::East => Gate { wall: Axis::Vertical, line: self.x + width, at: 2 * self.y + at },
        }
    }

    /// Removes the contents.
    pub(super) fn empty(&mut self) {
        self.contents = Contents::Emptied;
        if let Ok(room) = SharedRoom::new(self.room.emptied()) {
            self.room = room;
        }
    }

    /// Returns the port of an opening in the room's walls.
    pub(super) fn port(&self, gate: Gate, dimensions: Dimensions) -> Port {
        let port = |(side, at)| self.room.interior(dimensions).turned_port(self.quarters, side, at);
        self.side_of(gate).map_or_else(Port::default, port)
    }

    /// Returns the room without the contents that block an opening in its walls; `None` if the opening could still
    /// not be used.
    pub(super) fn cleared(&self, gate: Gate, dimensions: Dimensions) -> Option<PlacedRoom> {
        let (side, at) = self.side_of(gate)?;
        let (side, at) =
            side.before_turn(at, self.quarters, |side| 2 * self.room.side_length(side));
        let room = self.room.cleared(side, at, dimensions)?;
        let contents = self.contents.max(Contents::Cleared);
        Some(PlacedRoom { room, contents, ..self.clone() })
    }

    /// Returns the side in which an opening lies, and its distance from the side's left or upper end in half cells;
    /// `None` if it is not in this room's walls.
    pub fn side_of(&self, gate: Gate) -> Option<(Side, u32)> {
        Side::ALL.into_iter().find_map(|side| {
            let at = gate.at.checked_sub(self.gate(side, 0).at)?;
            let inside = (1..2 * self.side_length(side)).contains(&at);
            (inside && self.gate(side, at) == gate).then_some((side, at))
        })
    }
}
