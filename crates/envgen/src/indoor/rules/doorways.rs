//! `doorwayRule` with the third adaptation: every side of every room draws a doorway.

use crate::indoor::access::Interiors;
use crate::indoor::grid::{Gate, Grid, Opening, Origin, Side};
use crate::indoor::plan::PlacedRoom;
use crate::seed::Stream;

/// What became of the drawn doorways.
pub(in crate::indoor) struct Drawn {
    /// The openings, sorted and without repetition.
    pub(in crate::indoor) openings: Vec<Opening>,
    /// Drawn sides that stayed closed: behind them is the outer wall, something solid or, where
    /// contents count, nothing that a robot could enter.
    pub(in crate::indoor) closed: u64,
}

/// Draws once for every side, whatever lies behind it, and opens the wall in the middle of the
/// side. Where half a doorway or none would be free it is moved to the nearest whole place; the
/// contents count when `interiors` are given.
pub(in crate::indoor) fn place(
    grid: &Grid,
    rooms: &mut [PlacedRoom],
    probability: f64,
    interiors: Option<&Interiors>,
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
    for room in rooms.iter() {
        for side in room.doorways.iter() {
            match open(grid, rooms, room, side, interiors) {
                Some(opening) => drawn.openings.push(opening),
                None => drawn.closed += 1,
            }
        }
    }
    sort(&mut drawn.openings);
    drawn
}

/// Sorts openings by place and drops repetitions: two rooms may open the same wall.
pub(in crate::indoor) fn sort(openings: &mut Vec<Opening>) {
    openings.sort_unstable();
    openings.dedup_by_key(|opening| opening.gate);
}

fn open(
    grid: &Grid,
    rooms: &[PlacedRoom],
    room: &PlacedRoom,
    side: Side,
    interiors: Option<&Interiors>,
) -> Option<Opening> {
    let length = room.side_length(side);
    let whole = |at: u32| {
        let gate = room.gate(side, at);
        let whole = match interiors {
            Some(interiors) => interiors.leads_through(grid, rooms, gate).is_some(),
            None => is_whole(grid, gate),
        };
        whole.then_some(gate)
    };
    let middle = length;
    if let Some(gate) = whole(middle) {
        return Some(Opening { gate, origin: Origin::Drawn });
    }
    // To the letter, only the middle between two cells can be half free, and then one of them is
    // wholly so.
    let farthest = match interiors {
        Some(_) => length - 1,
        None => u32::from(length.is_multiple_of(2)),
    };
    (1..=farthest)
        .flat_map(|shift| [middle - shift, middle + shift])
        .find_map(whole)
        .map(|gate| Opening { gate, origin: Origin::Shifted })
}

/// Whether one and the same space lies behind the full width of an opening, on either side.
pub(in crate::indoor) fn is_whole(grid: &Grid, gate: Gate) -> bool {
    gate.cells(grid).iter().all(|&[a, b]| {
        (a.is_floor() && b.is_floor())
            || (a == b && matches!(a, crate::indoor::grid::Cell::Room(_)))
    })
}
