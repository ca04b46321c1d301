//! The rule `roomRule` with the fourth adaptation: rooms are drawn by how near their difficulty is to that of the map.

use crate::indoor::catalogue::SharedRoom;
use crate::indoor::grid::{Cell, Grid, Sides};
use crate::indoor::placed_room::PlacedRoom;
use crate::seed::Stream;
use crate::world::Contents;

/// The rooms that may be placed, and how they are placed.
pub(in crate::indoor) struct Choice<'a> {
    /// The allowed rooms.
    pub(in crate::indoor) rooms: &'a [SharedRoom],
    /// The probability of each allowed room.
    pub(in crate::indoor) probabilities: &'a [f64],
    /// Whether rooms that are not square may be turned by a quarter.
    pub(in crate::indoor) turn: bool,
}

/// The rooms of a plan, and how often each allowed room was the first drawn for a cell.
pub(in crate::indoor) struct Placed {
    pub(in crate::indoor) rooms: Vec<PlacedRoom>,
    pub(in crate::indoor) first_choice: Vec<u64>,
}

/// Fills the solid cells column by column. After a column, it advances by the widest room placed there. The cells
/// in between remain empty; they are the source of the paper's open areas.
pub(in crate::indoor) fn place(
    grid: &mut Grid,
    choice: &Choice<'_>,
    stream: &mut Stream,
) -> Placed {
    let mut placed = Placed { rooms: Vec::new(), first_choice: vec![0; choice.rooms.len()] };
    let mut untried = choice.probabilities.to_vec();
    let mut x = 0;
    while x < grid.width() {
        let (mut y, mut widest) = (0, 1);
        while y < grid.height() {
            if grid.at(x, y) != Cell::Solid {
                y += 1;
                continue;
            }
            untried.copy_from_slice(choice.probabilities);
            let room = draw(grid, choice, (x, y), &mut untried, &mut placed.first_choice, stream);
            let Some(room) = room else {
                y += 1;
                continue;
            };
            let (width, height) = room.size();
            grid.fill(x, y, width, height, Cell::Room(placed.rooms.len() as u32));
            placed.rooms.push(room);
            widest = widest.max(width);
            y += height;
        }
        x += widest;
    }
    placed
}

/// Draws rooms without replacement until one fits at the cell.
fn draw(
    grid: &Grid,
    choice: &Choice<'_>,
    (x, y): (u32, u32),
    untried: &mut [f64],
    first_choice: &mut [u64],
    stream: &mut Stream,
) -> Option<PlacedRoom> {
    let mut first = true;
    while let Some(drawn) = stream.weighted(untried) {
        if first {
            first_choice[drawn] += 1;
            first = false;
        }
        untried[drawn] = 0.0;
        let room = &choice.rooms[drawn];
        let oblong = room.width != room.height;
        let turns: &[u8] = match choice.turn && oblong {
            true if stream.chance(0.5) => &[1, 0],
            true => &[0, 1],
            false => &[0],
        };
        for &quarters in turns {
            let room = PlacedRoom {
                room: room.clone(),
                x,
                y,
                quarters,
                doorways: Sides::default(),
                contents: Contents::AsDesigned,
            };
            let (width, height) = room.size();
            if grid.is_solid(x, y, width, height) {
                return Some(room);
            }
        }
    }
    None
}
