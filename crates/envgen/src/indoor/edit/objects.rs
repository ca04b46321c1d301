//! The objects of a plan's rooms.

use glam::DVec2;

use super::{Change, EditError, PlanEditor};
use crate::indoor::blueprint::FloorPlan;
use crate::indoor::catalogue::{RoomDesign, SharedRoom};
use crate::indoor::placed_room::PlacedRoom;
use crate::world::{Contents, Obstacle, PartId, PartKind};

impl FloorPlan {
    /// Returns the indices of the room and of its object that an obstacle of the plan's world is; `None` for an
    /// obstacle that belongs to no room, such as a crate of the setting `clutter`.
    pub fn object_of(&self, part: PartId) -> Option<(usize, usize)> {
        let mut left = (part.kind == PartKind::Obstacle).then_some(part.index as usize)?;
        for (i, room) in self.rooms.iter().enumerate() {
            match left.checked_sub(room.room.obstacles.len()) {
                Some(behind) => left = behind,
                None => return Some((i, left)),
            }
        }
        None
    }

    /// Returns an object of a room, with its shape in metres in the frame of the world.
    pub fn object(&self, room: usize, object: usize) -> Option<Obstacle> {
        let found = self.rooms.get(room)?.room.obstacles.get(object)?;
        Some(Obstacle { shape: self.design_placement(room).shape(&found.shape), ..*found })
    }
}

impl PlanEditor {
    pub(super) fn add_object(
        &mut self,
        room: usize,
        object: Obstacle,
        step: &mut Vec<Change>,
    ) -> Result<(), EditError> {
        self.room(room)?;
        let shape = self.plan.design_placement(room).inverse().shape(&object.shape);
        self.furnish(room, step, |design| design.obstacles.push(Obstacle { shape, ..object }))
    }

    pub(super) fn move_object(
        &mut self,
        room: usize,
        object: usize,
        by: DVec2,
        step: &mut Vec<Change>,
    ) -> Result<(), EditError> {
        self.find_object(room, object)?;
        let back = self.plan.design_placement(room).inverse();
        let by = back.point(by) - back.point(DVec2::ZERO);
        self.furnish(room, step, |design| {
            let shape = &mut design.obstacles[object].shape;
            *shape = shape.moved(by);
        })
    }

    pub(super) fn turn_object(
        &mut self,
        room: usize,
        object: usize,
        angle: f64,
        step: &mut Vec<Change>,
    ) -> Result<(), EditError> {
        self.find_object(room, object)?;
        self.furnish(room, step, |design| {
            let shape = &mut design.obstacles[object].shape;
            *shape = shape.turned(angle);
        })
    }

    pub(super) fn remove_object(
        &mut self,
        room: usize,
        object: usize,
        step: &mut Vec<Change>,
    ) -> Result<(), EditError> {
        self.find_object(room, object)?;
        self.furnish(room, step, |design| _ = design.obstacles.remove(object))
    }

    fn find_object(&self, room: usize, object: usize) -> Result<(), EditError> {
        let room = self.room(room)?;
        let count = room.room.obstacles.len();
        let missing = || EditError::NoObject { room: room.room.name.clone(), object, count };
        (object < count).then_some(()).ok_or_else(missing)
    }

    /// Replaces a room by one with other contents. Rooms of the same design share it.
    fn furnish(
        &mut self,
        room: usize,
        step: &mut Vec<Change>,
        change: impl FnOnce(&mut RoomDesign),
    ) -> Result<(), EditError> {
        let old = &self.plan.rooms[room];
        let mut design = RoomDesign::clone(&old.room);
        change(&mut design);
        let (design, contents) = (SharedRoom::new(design)?, Contents::Edited);
        let new = PlacedRoom { room: design, contents, ..old.clone() };
        let (from, to) = (Some(Box::new(old.clone())), Some(Box::new(new)));
        self.record(Change::Room { index: room, from, to }, step);
        Ok(())
    }
}
