//! Which room each cell of a grid is in.

use crate::grid::GridFrame;
use crate::world::World;

/// For the middle of each cell one more than the index of its room, 0 outside all rooms; of several rooms the last.
pub(super) fn rooms_of_cells(world: &World, frame: GridFrame) -> Vec<u32> {
    let mut rooms = vec![0_u32; frame.len()];
    for (number, room) in (1..).zip(&world.rooms) {
        let bounds = room.shape.bounds();
        let (low, high) = (bounds.min - frame.origin, bounds.max - frame.origin);
        let cols = frame.middles(low.x, high.x, frame.cols);
        let rows = frame.middles(low.y, high.y, frame.rows);
        let (Some((left, right)), Some((bottom, top))) = (cols, rows) else { continue };
        for row in bottom..=top {
            for col in left..=right {
                if room.shape.contains(frame.center(col, row)) {
                    rooms[frame.index(col, row)] = number;
                }
            }
        }
    }
    rooms
}
