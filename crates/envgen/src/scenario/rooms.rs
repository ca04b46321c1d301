//! The rooms and other places that contain the cells of a grid.

use crate::geometry::Shape;
use crate::grid::GridFrame;
use crate::world::World;

/// Returns for each cell, by its centre, one more than the index of its room; 0 outside all rooms. If several rooms
/// contain it, the last one counts.
pub(super) fn rooms_of_cells(world: &World, frame: GridFrame) -> Vec<u32> {
    places_of_cells(world.rooms.iter().map(|room| &room.shape), frame)
}

/// The same for places of the given shapes instead of rooms.
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
