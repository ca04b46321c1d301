//! Manual changes of a plan, with undo and redo.

mod objects;
mod target;

use glam::DVec2;
use thiserror::Error;

pub use target::PlanTarget;

pub use super::plan_edit::Edit;

use super::blueprint::FloorPlan;
use super::catalogue::RoomError;
use super::grid::{Axis, Cell, Gate, Opening, Origin, Side, Sides, is_whole};
use super::placed_room::PlacedRoom;
use crate::history::History;
use crate::world::Contents;

/// The reasons why an edit is refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EditError {
    /// The room does not exist.
    #[error("there is no room {room}; the plan has {count}")]
    NoRoom {
        /// The requested index of the room.
        room: usize,
        /// Number of rooms.
        count: usize,
    },
    /// A room or hallway would leave the grid.
    #[error("{what} at column {x}, row {y} would leave the grid of {columns} by {rows} cells")]
    Outside {
        /// The room or hallway that would leave the grid.
        what: String,
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Columns of the grid.
        columns: u32,
        /// Rows of the grid.
        rows: u32,
    },
    /// A room or hallway would overlap something.
    #[error("{what} would overlap {with} at column {x}, row {y}")]
    Overlap {
        /// The room or hallway that would be placed.
        what: String,
        /// What it would overlap: a hallway, or the name of a room.
        with: String,
        /// Column of the first overlapping cell.
        x: u32,
        /// Row of the first overlapping cell.
        y: u32,
    },
    /// The cell is not a hallway.
    #[error("the cell at column {x}, row {y} is not a hallway")]
    NoHallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// There is no wall of a room at the position, or no single space behind the whole width of the doorway.
    #[error("a doorway at {0} would not lead from a room to one other space")]
    NoWall(Gate),
    /// The doorway is open already.
    #[error("the doorway at {0} is open already")]
    AlreadyOpen(Gate),
    /// There is no open doorway to close.
    #[error("there is no doorway at {0}")]
    NotOpen(Gate),
    /// The room has no object with this index.
    #[error("the room `{room}` has no object {object}; it has {count}")]
    NoObject {
        /// The room's name.
        room: String,
        /// The requested index of the object.
        object: usize,
        /// Number of objects in the room.
        count: usize,
    },
    /// The room's contents would be invalid.
    #[error(transparent)]
    Contents(#[from] RoomError),
}

/// A plan that is being edited. Every edit can be undone and redone. A refused edit changes nothing.
///
/// ```
/// use envgen::indoor::{Edit, IndoorSpec, PlanEditor};
/// use envgen::{Seed, Spec};
///
/// let mut editor = PlanEditor::new(IndoorSpec::default().generate(Seed(1))?);
/// let before = editor.plan().clone();
/// editor.apply(Edit::RemoveRoom { room: 0 })?;
/// assert_eq!(editor.plan().rooms().len() + 1, before.rooms().len());
/// assert!(editor.plan().is_edited());
/// assert!(editor.undo());
/// assert_eq!(editor.plan(), &before);
/// assert!(editor.redo());
/// let plan = editor.into_plan();
/// assert_ne!(plan, before);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PlanEditor {
    plan: FloorPlan,
    was_edited: bool,
    /// Whether the plan's edits are its only difference from the plan that its spec and seed give.
    is_complete: bool,
    history: History<Change>,
    /// The edits that were undone, the last one first.
    undone: Vec<Edit>,
}

/// A reversible change: the state before and the state after.
#[derive(Clone, Debug)]
enum Change {
    Cell {
        index: usize,
        from: Cell,
        to: Cell,
    },
    /// A change of a room. If one of the two states is absent, a room at the end is added or removed.
    Room {
        index: usize,
        from: Option<Box<PlacedRoom>>,
        to: Option<Box<PlacedRoom>>,
    },
    Opened(Opening),
    Closed(Opening),
}

impl PlanEditor {
    /// Creates an editor of a plan.
    pub fn new(plan: FloorPlan) -> Self {
        let was_edited = plan.edited;
        let is_complete = !plan.edited || !plan.edits.is_empty();
        PlanEditor {
            plan,
            was_edited,
            is_complete,
            history: History::default(),
            undone: Vec::new(),
        }
    }

    /// Returns the current plan.
    pub fn plan(&self) -> &FloorPlan {
        &self.plan
    }

    /// Returns the current plan and drops the editor.
    pub fn into_plan(self) -> FloorPlan {
        self.plan
    }

    /// Applies an edit. Edits that were undone before can no longer be redone.
    ///
    /// # Errors
    /// When the edit would overlap something, leave the grid or lead nowhere. Then nothing changes.
    pub fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        let mut step = Vec::new();
        if let Err(error) = self.perform(edit.clone(), &mut step) {
            self.revert(&step);
            return Err(error);
        }
        self.history.push(step);
        self.undone.clear();
        self.note(edit);
        Ok(())
    }

    /// Tests whether an edit is allowed now, without changing the plan.
    ///
    /// # Errors
    /// As [`PlanEditor::apply`].
    pub fn test(&mut self, edit: Edit) -> Result<(), EditError> {
        let mut step = Vec::new();
        let result = self.perform(edit, &mut step);
        self.revert(&step);
        result
    }

    /// Returns whether there is a change to undo.
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns whether there is a change to redo.
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Undoes the last change; returns whether there was one.
    pub fn undo(&mut self) -> bool {
        let mut history = std::mem::take(&mut self.history);
        let is_undone = history.undo(|step| self.revert(step));
        self.history = history;
        if is_undone {
            self.undone.extend(self.plan.edits.pop());
        }
        self.mark();
        is_undone
    }

    /// Repeats the edit that was undone last; returns whether there was one.
    pub fn redo(&mut self) -> bool {
        let mut history = std::mem::take(&mut self.history);
        let is_redone = history.redo(|step| step.iter().for_each(|change| self.change(change)));
        self.history = history;
        if is_redone && let Some(edit) = self.undone.pop() {
            self.note(edit);
        }
        self.mark();
        is_redone
    }

    /// Returns the position of a doorway that is nearest to a point in metres in the frame of the world; `None`
    /// outside the grid. Positions at which a doorway is possible take precedence.
    pub fn gate_at(&self, p: DVec2) -> Option<Gate> {
        self.plan.cell_at(p)?;
        let cells = self.plan.in_cells(p);
        let mut best: Option<((bool, f64), Gate)> = None;
        for wall in [Axis::Horizontal, Axis::Vertical] {
            let (across, along) = match wall {
                Axis::Horizontal => (cells.y, cells.x),
                Axis::Vertical => (cells.x, cells.y),
            };
            for at in [(2.0 * along).floor(), (2.0 * along).ceil()] {
                let gate = Gate { wall, line: across.round() as u32, at: (at as u32).max(1) };
                let (x, y) = gate.middle();
                let rank = (!self.takes_doorway(gate), DVec2::new(x, y).distance(cells));
                if best.is_none_or(|(least, _)| rank < least) {
                    best = Some((rank, gate));
                }
            }
        }
        best.map(|(_, gate)| gate)
    }

    /// Records an edit in the plan.
    fn note(&mut self, edit: Edit) {
        if self.is_complete {
            self.plan.edits.push(edit);
        }
        self.mark();
    }

    /// Records in the plan whether it was edited.
    fn mark(&mut self) {
        self.plan.edited = self.was_edited || self.history.can_undo();
    }

    fn perform(&mut self, edit: Edit, step: &mut Vec<Change>) -> Result<(), EditError> {
        match edit {
            Edit::AddRoom { room, x, y, quarters } => {
                let room = PlacedRoom {
                    room,
                    x,
                    y,
                    quarters: quarters % 4,
                    doorways: Sides::default(),
                    contents: Contents::AsDesigned,
                };
                self.check_free(&room)?;
                self.put(room, step);
            }
            Edit::MoveRoom { room, x, y } => {
                let moved = PlacedRoom { x, y, ..self.room(room)?.clone() };
                self.replace(room, moved, 0, step)?;
            }
            Edit::TurnRoom { room, quarters } => {
                let old = self.room(room)?.clone();
                let turned = PlacedRoom {
                    quarters: (old.quarters + quarters % 4) % 4,
                    doorways: old.doorways.turned(quarters % 4),
                    ..old
                };
                self.replace(room, turned, quarters % 4, step)?;
            }
            Edit::RemoveRoom { room } => {
                self.room(room)?;
                self.take(room, step);
            }
            Edit::AddHallway { x, y } => {
                let cell = self.cell(x, y, "a hallway")?;
                if !matches!(cell, Cell::Solid | Cell::Open) {
                    return Err(self.overlap("a hallway".to_owned(), x, y));
                }
                self.set_cell(x, y, Cell::Hallway, step);
            }
            Edit::RemoveHallway { x, y } => {
                if self.cell(x, y, "a hallway")? != Cell::Hallway {
                    return Err(EditError::NoHallway { x, y });
                }
                self.set_cell(x, y, Cell::Solid, step);
            }
            Edit::OpenDoorway(gate) => {
                if !self.takes_doorway(gate) {
                    return Err(EditError::NoWall(gate));
                }
                if self.find(gate).is_ok() {
                    return Err(EditError::AlreadyOpen(gate));
                }
                self.record(Change::Opened(Opening { gate, origin: Origin::Edited }), step);
            }
            Edit::CloseDoorway(gate) => {
                let at = self.find(gate).map_err(|_| EditError::NotOpen(gate))?;
                self.record(Change::Closed(self.plan.openings[at]), step);
            }
            Edit::AddObject { room, object } => self.add_object(room, object, step)?,
            Edit::MoveObject { room, object, by } => self.move_object(room, object, by, step)?,
            Edit::TurnObject { room, object, angle } => {
                self.turn_object(room, object, angle, step)?;
            }
            Edit::RemoveObject { room, object } => self.remove_object(room, object, step)?,
        }
        self.close_what_leads_nowhere(step);
        Ok(())
    }

    fn room(&self, room: usize) -> Result<&PlacedRoom, EditError> {
        let count = self.plan.rooms.len();
        self.plan.rooms.get(room).ok_or(EditError::NoRoom { room, count })
    }

    fn cell(&self, x: u32, y: u32, what: &str) -> Result<Cell, EditError> {
        let (columns, rows) = (self.plan.grid.width(), self.plan.grid.height());
        let outside = || EditError::Outside { what: what.to_owned(), x, y, columns, rows };
        self.plan.grid.get(x, y).ok_or_else(outside)
    }

    fn overlap(&self, what: String, x: u32, y: u32) -> EditError {
        let with = match self.plan.grid.get(x, y) {
            Some(Cell::Room(room)) => {
                format!("the room `{}`", self.plan.rooms[room as usize].room.name)
            }
            _ => "a hallway".to_owned(),
        };
        EditError::Overlap { what, with, x, y }
    }

    /// Checks that a room's cells lie in the grid, and that they are solid or open area.
    fn check_free(&self, room: &PlacedRoom) -> Result<(), EditError> {
        let what = format!("the room `{}`", room.room.name);
        let (width, height) = room.size();
        let (columns, rows) = (self.plan.grid.width(), self.plan.grid.height());
        let inside = room.x.checked_add(width).is_some_and(|right| right <= columns)
            && room.y.checked_add(height).is_some_and(|bottom| bottom <= rows);
        if !inside {
            return Err(EditError::Outside { what, x: room.x, y: room.y, columns, rows });
        }
        for y in room.y..room.y + height {
            for x in room.x..room.x + width {
                if !matches!(self.plan.grid.at(x, y), Cell::Solid | Cell::Open) {
                    return Err(self.overlap(what, x, y));
                }
            }
        }
        Ok(())
    }

    /// Moves or turns a room with its doorways. The room becomes the last one.
    fn replace(
        &mut self,
        room: usize,
        new: PlacedRoom,
        quarters: u8,
        step: &mut Vec<Change>,
    ) -> Result<(), EditError> {
        let old = self.plan.rooms[room].clone();
        let doorways: Vec<(Side, u32)> =
            self.plan.openings.iter().filter_map(|o| old.side_of(o.gate)).collect();
        self.take(room, step);
        self.check_free(&new)?;
        let gates: Vec<Gate> = doorways
            .into_iter()
            .map(|(side, at)| {
                let (mut side, mut at) = (side, at);
                let mut lengths = old.size();
                for _ in 0..quarters {
                    // Between north and west, and south and east, the direction of a side changes.
                    if matches!(side, Side::North | Side::South) {
                        at = 2 * lengths.0 - at;
                    }
                    side = side.turned(1);
                    lengths = (lengths.1, lengths.0);
                }
                new.gate(side, at)
            })
            .collect();
        self.put(new, step);
        for gate in gates {
            if self.takes_doorway(gate) && self.find(gate).is_err() {
                self.record(Change::Opened(Opening { gate, origin: Origin::Edited }), step);
            }
        }
        Ok(())
    }

    fn put(&mut self, room: PlacedRoom, step: &mut Vec<Change>) {
        let index = self.plan.rooms.len();
        self.fill(&room, Cell::Room(index as u32), step);
        self.record(Change::Room { index, from: None, to: Some(Box::new(room)) }, step);
    }

    fn take(&mut self, room: usize, step: &mut Vec<Change>) {
        let old = self.plan.rooms[room].clone();
        for opening in self.plan.openings.clone() {
            if old.side_of(opening.gate).is_some() {
                self.record(Change::Closed(opening), step);
            }
        }
        let left = if self.plan.spec.open_areas { Cell::Open } else { Cell::Solid };
        self.fill(&old, left, step);
        let last = self.plan.rooms.len() - 1;
        let moved = self.plan.rooms[last].clone();
        if room != last {
            self.fill(&moved, Cell::Room(room as u32), step);
            let (from, to) = (Some(Box::new(old)), Some(Box::new(moved.clone())));
            self.record(Change::Room { index: room, from, to }, step);
        }
        self.record(Change::Room { index: last, from: Some(Box::new(moved)), to: None }, step);
    }

    fn fill(&mut self, room: &PlacedRoom, to: Cell, step: &mut Vec<Change>) {
        let (width, height) = room.size();
        for y in room.y..room.y + height {
            for x in room.x..room.x + width {
                self.set_cell(x, y, to, step);
            }
        }
    }

    fn set_cell(&mut self, x: u32, y: u32, to: Cell, step: &mut Vec<Change>) {
        let index = self.plan.grid.index(x, y);
        let from = self.plan.grid.at(x, y);
        self.record(Change::Cell { index, from, to }, step);
    }

    fn close_what_leads_nowhere(&mut self, step: &mut Vec<Change>) {
        for opening in self.plan.openings.clone() {
            if !self.takes_doorway(opening.gate) {
                self.record(Change::Closed(opening), step);
            }
        }
    }

    /// Whether a doorway at a position would lie in a room's wall and be whole.
    fn takes_doorway(&self, gate: Gate) -> bool {
        let grid = &self.plan.grid;
        let (lines, along) = match gate.wall {
            Axis::Horizontal => (grid.height(), grid.width()),
            Axis::Vertical => (grid.width(), grid.height()),
        };
        if gate.line > lines || gate.at == 0 || gate.at >= 2 * along {
            return false;
        }
        let [[a, _], [b, _]] = gate.cells(grid);
        a != b && !(a.is_floor() && b.is_floor()) && is_whole(grid, gate)
    }

    fn find(&self, gate: Gate) -> Result<usize, usize> {
        self.plan.openings.binary_search_by_key(&gate, |opening| opening.gate)
    }

    fn record(&mut self, change: Change, step: &mut Vec<Change>) {
        self.change(&change);
        step.push(change);
    }

    fn change(&mut self, change: &Change) {
        match change {
            Change::Cell { index, to, .. } => {
                self.plan.grid.set_index(*index, *to);
            }
            Change::Room { index, to, .. } => self.set_room(*index, to.as_deref()),
            Change::Opened(opening) => self.open(*opening),
            Change::Closed(opening) => self.close(*opening),
        }
    }

    fn revert(&mut self, step: &[Change]) {
        for change in step.iter().rev() {
            match change {
                Change::Cell { index, from, .. } => {
                    self.plan.grid.set_index(*index, *from);
                }
                Change::Room { index, from, .. } => self.set_room(*index, from.as_deref()),
                Change::Opened(opening) => self.close(*opening),
                Change::Closed(opening) => self.open(*opening),
            }
        }
    }

    fn set_room(&mut self, index: usize, room: Option<&PlacedRoom>) {
        match room {
            Some(room) if index == self.plan.rooms.len() => self.plan.rooms.push(room.clone()),
            Some(room) => self.plan.rooms[index] = room.clone(),
            None => self.plan.rooms.truncate(index),
        }
    }

    fn open(&mut self, opening: Opening) {
        if let Err(at) = self.find(opening.gate) {
            self.plan.openings.insert(at, opening);
        }
    }

    fn close(&mut self, opening: Opening) {
        if let Ok(at) = self.find(opening.gate) {
            self.plan.openings.remove(at);
        }
    }
}

#[cfg(test)]
mod tests;
