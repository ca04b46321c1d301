//! The rule `doorwayRule` with the third adaptation: every side of every room draws a doorway.

use crate::indoor::access::Interiors;
use crate::indoor::dimensions::Dimensions;
use crate::indoor::grid::{Cell, Gate, Grid, Opening, Origin, Side, is_whole, sort_openings};
use crate::indoor::placed_room::PlacedRoom;
use crate::seed::Stream;

/// The result of drawing doorways.
pub(in crate::indoor) struct Drawn {
    /// The openings, sorted and without duplicates.
    pub(in crate::indoor) openings: Vec<Opening>,
    /// Number of drawn sides that stayed closed because the outer wall or a solid cell is behind them.
    pub(in crate::indoor) closed: u64,
}

/// Draws once for every side, whatever lies behind it, and opens the wall in the middle of the side. If only half
/// of a doorway or none of it would be free there, the doorway is moved to the nearest position where it is whole.
/// With `dimensions`, the contents count as well: a doorway is moved to a position where no contents block it; if
/// there are no such positions, the contents are removed.
pub(in crate::indoor) fn place(
    grid: &Grid,
    rooms: &mut [PlacedRoom],
    probability: f64,
    dimensions: Option<Dimensions>,
    stream: &mut Stream,
) -> Drawn {
    for room in rooms.iter_mut() {
        for side in Side::ALL {
            if stream.chance(probability) {
                room.doorways.insert(side);
            }
        }
    }
    let mut drawn = Drawn { openings: Vec::with_capacity(2 * rooms.len()), closed: 0 };
    let mut blocked = Vec::new();
    let interiors = dimensions.map(|dimensions| Interiors::new(grid, rooms, dimensions));
    let usable = |rooms: &[PlacedRoom], gate: Gate| match &interiors {
        Some(interiors) => interiors.leads_through(grid, rooms, gate).is_some(),
        None => is_whole(grid, gate),
    };
    for (i, room) in rooms.iter().enumerate() {
        for side in room.doorways.iter() {
            match nearest(room, side, dimensions.is_some(), |gate| usable(rooms, gate)) {
                Some(opening) => drawn.openings.push(opening),
                None => blocked.push((i, side)),
            }
        }
    }
    for (i, side) in blocked {
        let opening = dimensions.and_then(|dimensions| clear(grid, rooms, (i, side), dimensions));
        match opening {
            Some(opening) => drawn.openings.push(opening),
            None => drawn.closed += 1,
        }
    }
    sort_openings(&mut drawn.openings);
    drawn
}

/// Returns the position in a side, nearest to its middle, that `usable` accepts. Positions beside the middle are
/// tried if half a doorway can be free: between two cells, or anywhere.
fn nearest(
    room: &PlacedRoom,
    side: Side,
    anywhere: bool,
    usable: impl Fn(Gate) -> bool,
) -> Option<Opening> {
    let middle = room.side_length(side);
    if usable(room.gate(side, middle)) {
        return Some(Opening { gate: room.gate(side, middle), origin: Origin::Drawn });
    }
    // By the paper, only the middle between two cells can be half free, and then one of them is
    // wholly free.
    let farthest = if anywhere { middle - 1 } else { u32::from(middle.is_multiple_of(2)) };
    (1..=farthest)
        .flat_map(|shift| [middle - shift, middle + shift])
        .map(|at| room.gate(side, at))
        .find(|&gate| usable(gate))
        .map(|gate| Opening { gate, origin: Origin::Shifted })
}

/// Removes the contents that block a drawn doorway, nearest to the middle of its side.
fn clear(
    grid: &Grid,
    rooms: &mut [PlacedRoom],
    (room, side): (usize, Side),
    dimensions: Dimensions,
) -> Option<Opening> {
    // The room after a doorway's entry is cleared; `None` when that is impossible.
    let around = |gate: Gate| -> Option<Vec<(usize, PlacedRoom)>> {
        let cells = gate.first_cells().into_iter().flatten();
        let beside = cells.filter_map(|(x, y)| match grid.get(x, y) {
            Some(Cell::Room(i)) => Some(i as usize),
            _ => None,
        });
        let cleared = |i: usize| match rooms[i].port(gate, dimensions).usable() {
            true => Some((i, rooms[i].clone())),
            false => Some((i, rooms[i].cleared(gate, dimensions)?)),
        };
        is_whole(grid, gate).then(|| beside.map(cleared).collect()).flatten()
    };
    let opening = nearest(&rooms[room], side, true, |gate| around(gate).is_some())?;
    for (i, room) in around(opening.gate)? {
        rooms[i] = room;
    }
    Some(opening)
}
