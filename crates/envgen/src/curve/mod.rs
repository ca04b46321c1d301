//! Exact plane curves: lines, arcs and clothoids, and paths made of them.
//!
//! A [`Curve`] is a piece whose curvature changes linearly with the distance along it; OpenDRIVE calls such pieces
//! `line`, `arc` and `spiral`. A [`Path`] joins pieces, [`PathIndex`] finds the nearest point of a path, and
//! [`overlap`] finds whether a strip along a path overlaps itself.
//!
//! Every point is computed by a closed form within its piece, never by summing steps, so that its error does not
//! grow along the path. It remains within a few units in the last place of the coordinates.

mod bounds;
mod index;
mod line;
pub mod overlap;
mod path;
mod segment;
mod series;
mod tree;

pub use index::{Located, PathIndex};
pub(crate) use line::corner;
pub use path::{Path, Walk};
pub use segment::Curve;
