//! The repair of the profile `guaranteed`, after which every place can be reached.

use std::collections::BTreeMap;

use crate::indoor::access::Interiors;
use crate::indoor::dimensions::Dimensions;
use crate::indoor::grid::{Cell, Gate, Grid, Opening, Origin, Side, sort_openings};
use crate::indoor::placed_room::PlacedRoom;
use crate::seed::Stream;
use crate::union_find::UnionFind;
use crate::world::Contents;

/// A position for a further doorway, and the places that it would join.
struct Candidate {
    gate: Gate,
    places: [usize; 2],
    /// Whether the position is the middle of a room's side.
    middle: bool,
}

/// Adds doorways until every floor cell and every part of a room is connected to the hallways.
///
/// In each round, every unreachable component that borders on the reachable one gets a doorway, drawn among the
/// middles of sides if possible, otherwise among all positions where it is whole. If contents block every position,
/// the rooms concerned are emptied. Few or no rooms are emptied if every part of each room touches several sides.
pub(in crate::indoor) fn repair(
    grid: &Grid,
    rooms: &mut [PlacedRoom],
    openings: &mut Vec<Opening>,
    dimensions: Dimensions,
    stream: &mut Stream,
) {
    let Some(root) = grid.cells().iter().position(|&cell| cell == Cell::Hallway) else { return };
    loop {
        let interiors = Interiors::new(grid, rooms, dimensions);
        let unreached = connect(grid, rooms, openings, &interiors, root, stream);
        sort_openings(openings);
        if unreached.is_empty() || !empty(grid, rooms, &unreached) {
            return;
        }
    }
}

/// Adds doorways; returns the rooms that contain, or border on, places that remain unreached.
fn connect(
    grid: &Grid,
    rooms: &[PlacedRoom],
    openings: &mut Vec<Opening>,
    interiors: &Interiors,
    root: usize,
    stream: &mut Stream,
) -> Vec<usize> {
    let mut sets = UnionFind::new(interiors.count as usize);
    let floor = |x: u32, y: u32| {
        grid.get(x, y)
            .is_some_and(Cell::is_floor)
            .then(|| interiors.floor[grid.index(x, y)] as usize)
    };
    for y in 0..grid.height() {
        for x in 0..grid.width() {
            let Some(here) = floor(x, y) else { continue };
            for there in [floor(x + 1, y), floor(x, y + 1)].into_iter().flatten() {
                sets.join(here, there);
            }
        }
    }
    for opening in openings.iter() {
        if let [Some(a), Some(b)] = interiors.places(grid, rooms, opening.gate) {
            sets.join(a, b);
        }
    }
    let root = interiors.floor[root] as usize;
    let mut candidates = candidates(grid, rooms, interiors, &mut sets);
    loop {
        candidates.retain(|c| sets.find(c.places[0]) != sets.find(c.places[1]));
        let reached = sets.find(root);
        let mut pieces: BTreeMap<usize, (Vec<Gate>, Vec<Gate>)> = BTreeMap::new();
        for candidate in &candidates {
            let piece = match candidate.places.map(|place| sets.find(place)) {
                [a, b] if a == reached => b,
                [a, b] if b == reached => a,
                _ => continue,
            };
            let (middles, others) = pieces.entry(piece).or_default();
            if candidate.middle { middles } else { others }.push(candidate.gate);
        }
        if pieces.is_empty() {
            break;
        }
        for (middles, others) in pieces.into_values() {
            let gates = if middles.is_empty() { others } else { middles };
            let gate = gates[stream.below(gates.len() as u64) as usize];
            openings.push(Opening { gate, origin: Origin::Added });
            if let Some([a, b]) = interiors.leads_through(grid, rooms, gate) {
                sets.join(a, b);
            }
        }
    }
    let reached = sets.find(root);
    let mut unreached: Vec<usize> = (0..rooms.len())
        .filter(|&room| {
            let first = interiors.first_part[room] as usize;
            let parts = interiors.of(room).parts().len();
            parts == 0 || (first..first + parts).any(|part| sets.find(part) != reached)
        })
        .collect();
    let all = rooms;
    // An unreached piece of floor is opened by emptying one of the rooms around it.
    let mut beside: BTreeMap<usize, usize> = BTreeMap::new();
    for y in 0..grid.height() {
        for x in 0..grid.width() {
            let Some(piece) = floor(x, y).map(|here| sets.find(here)) else { continue };
            if piece == reached || beside.contains_key(&piece) {
                continue;
            }
            let (left, up) = (x.wrapping_sub(1), y.wrapping_sub(1));
            let around = [(x + 1, y), (x, y + 1), (left, y), (x, up)];
            let mut rooms = around.into_iter().filter_map(|(x, y)| match grid.get(x, y) {
                Some(Cell::Room(room)) => Some(room as usize),
                _ => None,
            });
            if let Some(room) = rooms.find(|&room| furnished(&all[room])) {
                beside.insert(piece, room);
            }
        }
    }
    unreached.extend(beside.into_values());
    unreached.sort_unstable();
    unreached.dedup();
    unreached
}

/// Returns every position for a doorway between components that are not connected yet, each once.
fn candidates(
    grid: &Grid,
    rooms: &[PlacedRoom],
    interiors: &Interiors,
    sets: &mut UnionFind,
) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for (i, room) in rooms.iter().enumerate() {
        let first = interiors.first_part[i] as usize;
        for side in Side::ALL {
            let length = room.side_length(side);
            for at in 1..2 * length {
                let port = interiors.of(i).turned_port(room.quarters, side, at);
                let Some(part) = port.part.filter(|_| port.clear) else { continue };
                let gate = room.gate(side, at);
                let Some([a, b]) = interiors.leads_through(grid, rooms, gate) else { continue };
                let here = first + part as usize;
                let there = if a == here { b } else { a };
                // A wall between two rooms is seen from both: the earlier room reports it.
                if (there >= interiors.first_part[0] as usize && there < here)
                    || sets.find(a) == sets.find(b)
                {
                    continue;
                }
                candidates.push(Candidate { gate, places: [a, b], middle: at == length });
            }
        }
    }
    candidates
}

fn furnished(room: &PlacedRoom) -> bool {
    room.contents != Contents::Emptied
}

/// Removes the contents of rooms, or those of their neighbours if they have none; returns whether there were any
/// contents to remove.
fn empty(grid: &Grid, rooms: &mut [PlacedRoom], unreached: &[usize]) -> bool {
    let mut which: Vec<usize> =
        unreached.iter().copied().filter(|&i| furnished(&rooms[i])).collect();
    if which.is_empty() {
        let neighbours = unreached.iter().flat_map(|&i| {
            let room = &rooms[i];
            Side::ALL.into_iter().flat_map(move |side| {
                (1..2 * room.side_length(side)).map(move |at| room.gate(side, at))
            })
        });
        for gate in neighbours {
            for cell in gate.cells(grid).into_iter().flatten() {
                if let Cell::Room(i) = cell
                    && furnished(&rooms[i as usize])
                {
                    which.push(i as usize);
                }
            }
        }
        which.sort_unstable();
        which.dedup();
    }
    for &i in &which {
        rooms[i].empty();
    }
    !which.is_empty()
}
