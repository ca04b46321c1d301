//! Outlines of shapes as polygons, for meshes and for file formats that have no discs.

use glam::DVec2;

use crate::geometry::{Shape, regular_polygon};
use crate::pieces::LINE_THICKNESS;

/// The greatest distance in metres by which the sides of a disc's outline lie inside its circle.
pub const ROUNDNESS: f64 = 1e-3;

/// The fewest and most sides of an outline of a disc.
const SIDES: std::ops::RangeInclusive<usize> = 12..=256;

/// Returns the outline of a shape as the point in its middle, and the corners relative to that point,
/// counter-clockwise. A disc becomes a polygon with many sides, and a line becomes a strip of [`LINE_THICKNESS`].
///
/// ```
/// use envgen::geometry::{Shape, signed_area};
/// use envgen::glam::DVec2;
/// use envgen::outline::outline;
///
/// let disc = Shape::Disc { center: DVec2::new(3.0, 1.0), radius: 0.5 };
/// let (middle, corners) = outline(&disc);
/// assert_eq!(middle, DVec2::new(3.0, 1.0));
/// assert!((signed_area(&corners) / disc.area() - 1.0).abs() < 0.01);
/// ```
pub fn outline(shape: &Shape) -> (DVec2, Vec<DVec2>) {
    match shape {
        Shape::Disc { center, radius } => (*center, regular_polygon(*radius, sides(*radius))),
        Shape::Box { center, half_size, heading } => {
            let around =
                Shape::Box { center: DVec2::ZERO, half_size: *half_size, heading: *heading };
            (*center, around.corners())
        }
        Shape::Segment { a, b } => {
            let middle = 0.5 * (*a + *b);
            let line = Shape::thick_segment(*a - middle, *b - middle, LINE_THICKNESS, 0.0);
            (middle, line.corners())
        }
        Shape::Polygon { vertices } => {
            let middle = shape.bounds().center();
            (middle, vertices.iter().map(|corner| *corner - middle).collect())
        }
    }
}

/// Returns the number of sides that keeps a regular polygon within [`ROUNDNESS`] of its circle.
fn sides(radius: f64) -> usize {
    // The middle of a side is radius * (1 - cos(pi / n)) inside, about radius * pi^2 / (2 n^2).
    let sides = std::f64::consts::PI * (radius / (2.0 * ROUNDNESS)).sqrt();
    (sides.ceil() as usize).clamp(*SIDES.start(), *SIDES.end())
}
