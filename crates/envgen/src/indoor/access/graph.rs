//! The graph of a plan's places and the links between them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;
use serde::Serialize;

use super::interiors::Interiors;
use crate::indoor::blueprint::FloorPlan;
use crate::indoor::grid::Cell;
use crate::union_find::UnionFind;

/// The places of a plan and the links between them. Places are the cells of hallways and open areas, and the rooms.
///
/// A robot with the spec's footprint can pass every link. A room that is divided by its contents counts as several
/// places, a room without free space as none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccessGraph {
    places: Vec<Place>,
    links: Vec<Link>,
    rooms: u32,
    /// Number of squares of four floor cells. A cycle of their links encloses nothing.
    squares: u64,
}

/// A place of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Place {
    /// The kind of place.
    pub kind: PlaceKind,
    /// A point in the place where the footprint fits, in metres in the frame of the world.
    pub at: DVec2,
}

/// The kind of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaceKind {
    /// A cell of a hallway.
    Hallway {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// A cell of an open area.
    Open {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// A room, or a part of one that its contents divide.
    Room {
        /// Index in [`FloorPlan::rooms`].
        room: u32,
        /// Number of the part, counted from 0.
        part: u32,
    },
}

/// A connection between two places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Link {
    /// The places that the link joins.
    pub places: [u32; 2],
    /// Index in [`FloorPlan::openings`] of the opening through which the link leads; `None` between neighbouring
    /// floor cells.
    pub opening: Option<u32>,
    /// Length of the straight lines from place to opening to place, in metres.
    pub length: f64,
}

impl FloorPlan {
    /// Determines which places are connected for a robot of the spec's footprint.
    pub fn access(&self) -> AccessGraph {
        AccessGraph::new(self)
    }
}

impl AccessGraph {
    fn new(plan: &FloorPlan) -> Self {
        let interiors = Interiors::new(&plan.grid, &plan.rooms, plan.spec.dimensions());
        let grid = &plan.grid;
        let mut places = Vec::with_capacity(interiors.count as usize);
        for (i, cell) in grid.cells().iter().enumerate() {
            let (x, y) = grid.position(i);
            let kind = match cell {
                Cell::Hallway => PlaceKind::Hallway { x, y },
                Cell::Open => PlaceKind::Open { x, y },
                _ => continue,
            };
            places.push(Place { kind, at: plan.cell_middle(x, y) });
        }
        for room in 0..plan.rooms.len() {
            let frame = plan.metric_placement(room);
            for (part, free) in interiors.of(room).parts().iter().enumerate() {
                let kind = PlaceKind::Room { room: room as u32, part: part as u32 };
                places.push(Place { kind, at: frame.point(free.anchor) });
            }
        }
        let mut links = Vec::new();
        let mut squares = 0;
        let floor = |x: u32, y: u32| {
            grid.get(x, y).is_some_and(Cell::is_floor).then(|| interiors.floor[grid.index(x, y)])
        };
        for y in 0..grid.height() {
            for x in 0..grid.width() {
                let Some(here) = floor(x, y) else { continue };
                let (right, below) = (floor(x + 1, y), floor(x, y + 1));
                for there in [right, below].into_iter().flatten() {
                    let places = [here, there];
                    links.push(Link { places, opening: None, length: plan.spec.cell_size });
                }
                let square = right.is_some() && below.is_some() && floor(x + 1, y + 1).is_some();
                squares += u64::from(square);
            }
        }
        for (i, opening) in plan.openings.iter().enumerate() {
            if let [Some(a), Some(b)] = interiors.places(grid, &plan.rooms, opening.gate) {
                let door = plan.gate_middle(opening.gate);
                let length = places[a].at.distance(door) + places[b].at.distance(door);
                links.push(Link { places: [a as u32, b as u32], opening: Some(i as u32), length });
            }
        }
        AccessGraph { places, links, rooms: plan.rooms.len() as u32, squares }
    }

    /// Returns the places: floor cells row by row from the top, then the parts of the rooms.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Returns the links between the places.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the number of connected components.
    pub fn parts(&self) -> u64 {
        let sets = self.sets();
        (0..self.places.len()).filter(|&i| sets.represents(i)).count() as u64
    }

    /// Returns the number of independent cycles. Cycles inside an open area do not count.
    pub fn cycles(&self) -> u64 {
        (self.links.len() as u64 + self.parts()) - self.places.len() as u64 - self.squares
    }

    /// Returns the number of places with only one link: first in hallways and open areas, then in rooms.
    pub fn dead_ends(&self) -> [u64; 2] {
        let mut links = vec![0_u32; self.places.len()];
        self.links.iter().flat_map(|link| link.places).for_each(|i| links[i as usize] += 1);
        let mut ends = [0; 2];
        for (place, _) in self.places.iter().zip(links).filter(|(_, links)| *links == 1) {
            ends[usize::from(matches!(place.kind, PlaceKind::Room { .. }))] += 1;
        }
        ends
    }

    /// Returns the number of openings through which each room can be entered.
    pub fn doors_by_room(&self) -> Vec<u32> {
        let mut doors = vec![0; self.rooms as usize];
        for place in self.links.iter().flat_map(|link| link.places) {
            if let PlaceKind::Room { room, .. } = self.places[place as usize].kind {
                doors[room as usize] += 1;
            }
        }
        doors
    }

    /// Returns the length of the shortest path from a place to every other place, in metres, which is infinite if
    /// no path exists. It takes n log n steps for n places.
    pub fn distances(&self, from: u32) -> Vec<f64> {
        let mut starts = vec![0_u32; self.places.len() + 1];
        self.links.iter().flat_map(|link| link.places).for_each(|i| starts[i as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut edges = vec![(0_u32, 0.0); 2 * self.links.len()];
        for link in &self.links {
            let [a, b] = link.places;
            for (a, b) in [(a, b), (b, a)] {
                edges[next[a as usize] as usize] = (b, link.length);
                next[a as usize] += 1;
            }
        }
        let mut distances = vec![f64::INFINITY; self.places.len()];
        let mut queue = BinaryHeap::new();
        if let Some(first) = distances.get_mut(from as usize) {
            *first = 0.0;
            queue.push(Reverse((0_u64, from)));
        }
        while let Some(Reverse((bits, i))) = queue.pop() {
            // The bits of non-negative numbers sort as the numbers do.
            let distance = f64::from_bits(bits);
            if distance > distances[i as usize] {
                continue;
            }
            for &(j, length) in &edges[starts[i as usize] as usize..starts[i as usize + 1] as usize]
            {
                let there = distance + length;
                if there < distances[j as usize] {
                    distances[j as usize] = there;
                    queue.push(Reverse((there.to_bits(), j)));
                }
            }
        }
        distances
    }

    fn sets(&self) -> UnionFind {
        let mut sets = UnionFind::new(self.places.len());
        for link in &self.links {
            sets.join(link.places[0] as usize, link.places[1] as usize);
        }
        sets
    }
}
