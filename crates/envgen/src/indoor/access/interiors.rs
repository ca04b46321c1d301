//! The free space of all rooms of a plan together.

use std::sync::Arc;

use crate::indoor::dimensions::Dimensions;
use crate::indoor::grid::{Cell, Gate, Grid, is_whole};
use crate::indoor::interior::Interior;
use crate::indoor::placed_room::PlacedRoom;

/// The free space inside each room of a plan, and numbers for all its places: first the floor cells, then the parts
/// of the rooms.
#[derive(Clone, Debug)]
pub(in crate::indoor) struct Interiors {
    interiors: Vec<Arc<Interior>>,
    pub(in crate::indoor) first_part: Vec<u32>,
    /// Number of each floor cell.
    pub(in crate::indoor) floor: Vec<u32>,
    pub(in crate::indoor) count: u32,
}

impl Interiors {
    pub(in crate::indoor) fn new(
        grid: &Grid,
        rooms: &[PlacedRoom],
        dimensions: Dimensions,
    ) -> Self {
        let mut count = 0;
        let mut number = |n: usize| {
            let first = count;
            count += n as u32;
            first
        };
        let floor = grid
            .cells()
            .iter()
            .map(|cell| if cell.is_floor() { number(1) } else { u32::MAX })
            .collect();
        let mut interiors: Vec<Arc<Interior>> = Vec::with_capacity(rooms.len());
        let mut first_part = Vec::with_capacity(rooms.len());
        for room in rooms {
            let interior = room.room.interior(dimensions);
            first_part.push(number(interior.parts().len()));
            interiors.push(interior);
        }
        Interiors { interiors, first_part, floor, count }
    }

    pub(in crate::indoor) fn of(&self, room: usize) -> &Interior {
        &self.interiors[room]
    }

    /// Returns the places on both sides of an opening; `None` if a robot cannot enter.
    pub(in crate::indoor) fn places(
        &self,
        grid: &Grid,
        rooms: &[PlacedRoom],
        gate: Gate,
    ) -> [Option<usize>; 2] {
        gate.first_cells().map(|cell| {
            let (x, y) = cell?;
            match grid.get(x, y)? {
                Cell::Solid => None,
                Cell::Hallway | Cell::Open => Some(self.floor[grid.index(x, y)] as usize),
                Cell::Room(i) => {
                    let room = &rooms[i as usize];
                    let (side, at) = room.side_of(gate)?;
                    let port = self.interiors[i as usize].turned_port(room.quarters, side, at);
                    Some(self.first_part[i as usize] as usize + port.part? as usize)
                }
            }
        })
    }

    /// Returns the places that an opening would join if it is possible there: if it is whole and no contents are
    /// right behind it.
    pub(in crate::indoor) fn leads_through(
        &self,
        grid: &Grid,
        rooms: &[PlacedRoom],
        gate: Gate,
    ) -> Option<[usize; 2]> {
        if !is_whole(grid, gate) {
            return None;
        }
        let clear = gate.first_cells().into_iter().all(|cell| {
            let Some(Cell::Room(i)) = cell.and_then(|(x, y)| grid.get(x, y)) else { return true };
            let room = &rooms[i as usize];
            room.side_of(gate).is_some_and(|(side, at)| {
                self.interiors[i as usize].turned_port(room.quarters, side, at).clear
            })
        });
        match self.places(grid, rooms, gate) {
            [Some(a), Some(b)] if clear => Some([a, b]),
            _ => None,
        }
    }
}
