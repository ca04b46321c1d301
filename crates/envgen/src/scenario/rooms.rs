//! Which room, or other place, each cell of a grid is in.

use crate::geometry::Shape;
use crate::grid::GridFrame;
use crate::world::World;

/// For the middle of each cell one more than the index of its room, 0 outside all rooms; of several rooms the last.
pub(super) fn rooms_of_cells(world: &World, frame: GridFrame) -> Vec<u32> {
    places_of_cells(world.rooms.iter().map(|room| &room.shape), frame)
}

/// The same for places of these shapes in place of the rooms.
pub(super) fn places_of_cells<'a>(
    shapes: impl Iterator<Item = &'a Shape>,
    frame: GridFrame,
) -> Vec<u32> {
    let mut places = vec![0_u32; frame.len()];
    for (number, shape) in (1..).zip(shapes) {
        let bounds = shape.bounds();
        let (low, high) = (bounds.min - frame.origin, bounds.max - frame.origin);
        let cols = frame.middles(low.x, high.x, frame.cols);
        let rows = frame.middles(low.y, high.y, frame.rows);
        let (Some((left, right)), Some((bottom, top))) = (cols, rows) else { continue };
        for row in bottom..=top {
            for col in left..=right {
                if shape.contains(frame.center(col, row)) {
                    places[frame.index(col, row)] = number;
                }
            }
        }
    }
    places
}
