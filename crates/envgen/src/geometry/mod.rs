//! Plane geometry in metres and radians: x points right, y points up, and headings are counter-clockwise from +x.

mod polygon;
mod pose;
mod rect;
mod segment;
mod shape;

pub(crate) use polygon::polygon_contains;
pub use polygon::{edges, regular_polygon, signed_area};
pub use pose::{Pose, unit_vector, wrap_angle};
pub use rect::Rect;
pub(crate) use segment::{distance_between_segments, split_segment};
pub use segment::{distance_to_segment, nearest_on_segment, segments_cross};
pub use shape::{Shape, box_axis};
