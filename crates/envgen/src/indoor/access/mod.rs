//! Access: which places of a plan are connected.

mod graph;
mod repair;

use std::sync::Arc;

pub use graph::{AccessGraph, Link, Place, PlaceKind};
pub(super) use repair::repair;

use super::grid::{Cell, Gate, Grid};
use super::interior::{Dimensions, Interior};
use super::plan::PlacedRoom;
use super::rules::doorways::is_whole;
use crate::union_find::UnionFind;

/// The free space inside each room of a plan, and numbers for all its places: the floor cells first,
/// then the parts of the rooms.
#[derive(Clone, Debug)]
pub(super) struct Interiors {
    interiors: Vec<Arc<Interior>>,
    first_part: Vec<u32>,
    /// Number of each floor cell.
    floor: Vec<u32>,
    count: u32,
}

impl Interiors {
    pub(super) fn new(grid: &Grid, rooms: &[PlacedRoom], dimensions: Dimensions) -> Self {
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

    pub(super) fn of(&self, room: usize) -> &Interior {
        &self.interiors[room]
    }

    /// The places on both sides of an opening; `None` where a robot cannot enter.
    fn places(&self, grid: &Grid, rooms: &[PlacedRoom], gate: Gate) -> [Option<usize>; 2] {
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

    /// The places that an opening would join, when it is possible there: whole, and with no contents right
    /// behind it.
    pub(super) fn leads_through(
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

/// The connectivity of the hallway cells alone, without rooms and open areas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HallwayShape {
    pub(super) cells: u64,
    /// Connected components.
    pub(super) parts: u64,
    /// Independent cycles: links minus cells plus parts.
    pub(super) cycles: u64,
    /// Cells with one hallway neighbour or none.
    pub(super) ends: u64,
}

pub(super) fn hallway_shape(grid: &Grid) -> HallwayShape {
    let hallway = |x: u32, y: u32| grid.get(x, y) == Some(Cell::Hallway);
    let mut sets = UnionFind::new(grid.cells().len());
    let (mut cells, mut links, mut joins, mut ends) = (0, 0, 0, 0);
    for y in 0..grid.height() {
        for x in 0..grid.width() {
            if !hallway(x, y) {
                continue;
            }
            cells += 1;
            let here = grid.index(x, y);
            for (x, y) in [(x + 1, y), (x, y + 1)] {
                if hallway(x, y) {
                    links += 1;
                    joins += u64::from(sets.join(here, grid.index(x, y)));
                }
            }
            let neighbours =
                [(x + 1, y), (x, y + 1), (x.wrapping_sub(1), y), (x, y.wrapping_sub(1))];
            ends += u64::from(neighbours.iter().filter(|&&(x, y)| hallway(x, y)).count() < 2);
        }
    }
    HallwayShape { cells, parts: cells - joins, cycles: links - joins, ends }
}
