//! The cells of landscapes as rectangles.

use bevy::prelude::*;

use crate::part::Ground;
use crate::shape::PartShape;

/// Returns the rectangles that fill a block of ground, each with its class, counted from 1. Neighbouring
/// cells of the same class in a row are one rectangle. Corners are counter-clockwise, in the frame of the
/// environment.
pub(crate) fn class_rectangles(
    at: &Transform,
    shape: &PartShape,
    ground: &Ground,
) -> Vec<(u16, [Vec2; 4])> {
    let PartShape::Box { half_size } = shape else { return Vec::new() };
    let corner = |row: usize, col: usize| {
        let local = Vec2::new(col as f32, -(row as f32)) * ground.cell;
        at.translation.truncate() + Vec2::new(-half_size.x, half_size.y) + local
    };
    let mut rectangles = Vec::new();
    for (row, classes) in ground.classes.chunks(ground.cols.max(1) as usize).enumerate() {
        let mut from = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            if run[0] > 0 {
                let corners = [
                    corner(row + 1, from),
                    corner(row + 1, to),
                    corner(row, to),
                    corner(row, from),
                ];
                rectangles.push((run[0], corners));
            }
            from = to;
        }
    }
    rectangles
}
