//! The parts of a plan that can be edited, and queries for those at a point.

use glam::DVec2;

use crate::geometry::{Rect, Shape};
use crate::indoor::blueprint::FloorPlan;
use crate::indoor::grid::{Cell, Gate};
use crate::indoor::world;

/// A part of a plan that can be edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanTarget {
    /// A room, by its index in [`FloorPlan::rooms`].
    Room(usize),
    /// A cell of a hallway.
    Hallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// An opening in a wall.
    Doorway(Gate),
    /// An object in a room.
    Object {
        /// Index of the room in [`FloorPlan::rooms`].
        room: usize,
        /// Index of the object in the room's obstacles.
        object: usize,
    },
}

impl FloorPlan {
    /// Returns the column and row of the cell at a point in metres in the frame of the world; `None` outside the grid.
    pub fn cell_at(&self, p: DVec2) -> Option<(u32, u32)> {
        let cells = self.in_cells(p);
        let size = DVec2::new(f64::from(self.grid.width()), f64::from(self.grid.height()));
        let is_inside = cells.cmpge(DVec2::ZERO).all() && cells.cmplt(size).all();
        is_inside.then_some((cells.x as u32, cells.y as u32))
    }

    /// Returns the position of a point in columns and rows from the upper left corner of the grid.
    pub(super) fn in_cells(&self, p: DVec2) -> DVec2 {
        let cells = p / self.spec.cell_size;
        DVec2::new(cells.x, f64::from(self.grid.height()) - cells.y)
    }

    /// Returns the part that can be edited at a point in metres in the frame of the world: an object, an opening
    /// within a distance of `reach`, or the room or hallway of the cell. `None` on open areas, on solid ground and
    /// outside the grid.
    pub fn target_at(&self, p: DVec2, reach: f64) -> Option<PlanTarget> {
        let (x, y) = self.cell_at(p)?;
        let cell = self.grid.at(x, y);
        let objects = |room: usize| {
            let count = self.rooms[room].room.obstacles.len();
            let at_p = (0..count).filter_map(move |object| {
                let shape = self.object(room, object)?.shape;
                shape.contains(p).then_some((shape.area(), PlanTarget::Object { room, object }))
            });
            // The smallest: what is on or below another one is not hidden by it.
            at_p.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, object)| object)
        };
        let doorways = self.openings.iter().map(|opening| opening.gate);
        let near = doorways
            .map(|gate| (self.doorway_outline(gate).distance(p), gate))
            .filter(|(distance, _)| *distance <= reach)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let object = if let Cell::Room(room) = cell { objects(room as usize) } else { None };
        object.or(near.map(|(_, gate)| PlanTarget::Doorway(gate))).or(match cell {
            Cell::Room(room) => Some(PlanTarget::Room(room as usize)),
            Cell::Hallway => Some(PlanTarget::Hallway { x, y }),
            Cell::Open | Cell::Solid => None,
        })
    }

    /// Returns the outline of a part in metres in the frame of the world; `None` if the part does not exist.
    pub fn outline(&self, target: PlanTarget) -> Option<Shape> {
        match target {
            PlanTarget::Room(room) => {
                let room = self.rooms.get(room)?;
                Some(self.cells_outline(room.x, room.y, room.size()))
            }
            PlanTarget::Hallway { x, y } => {
                (self.grid.get(x, y)? == Cell::Hallway).then(|| self.cells_outline(x, y, (1, 1)))
            }
            PlanTarget::Doorway(gate) => {
                let found = self.openings.binary_search_by_key(&gate, |opening| opening.gate);
                found.ok().map(|_| self.doorway_outline(gate))
            }
            PlanTarget::Object { room, object } => Some(self.object(room, object)?.shape),
        }
    }

    /// Returns the outline of a rectangle of cells, inside or outside the grid.
    pub fn cells_outline(&self, x: u32, y: u32, (width, height): (u32, u32)) -> Shape {
        let right = f64::from(x) + f64::from(width);
        let bottom = f64::from(y) + f64::from(height);
        let (min, max) = (self.point(f64::from(x), bottom), self.point(right, f64::from(y)));
        Shape::from_rect(Rect::new(min, max))
    }

    /// Returns the outline of an opening, whether it exists or not.
    pub fn doorway_outline(&self, gate: Gate) -> Shape {
        Shape::from_rect(world::doorway_rect(self, gate))
    }
}
