//! The surroundings of doorways: what is near them, and which of them are narrower than their wall is thick.

use glam::DVec2;

use crate::geometry::{Rect, Shape};
use crate::grid::{Convex, GridIndex, index_area};
use crate::world::Doorway;

/// Walls within this distance of a doorway, in metres, touch it.
const TOUCH: f64 = 0.02;

/// The most cells of an index in which bounds are listed, on average.
const LISTINGS: usize = 16;

/// Indexes, for the middle of each doorway, the numbers of the bounds within a reach of it in metres, and perhaps some
/// farther ones.
pub(crate) fn near_middles<'a>(
    doorways: impl Iterator<Item = &'a Doorway> + Clone,
    bounds: impl Iterator<Item = Rect>,
    reach: f64,
) -> GridIndex {
    let bounds: Vec<Rect> = bounds.map(|bounds| bounds.grown(reach)).collect();
    let count = doorways.clone().count() as f64;
    let middles = doorways.map(|doorway| doorway.shape.bounds().center());
    let area = index_area(Rect::around(middles), 1.0);
    GridIndex::new(area, count, bounds.len(), Some(LISTINGS), |i, frame, visit| {
        frame.touched_runs(&Convex::Polygon(&Shape::from_rect(bounds[i]).corners()), visit);
    })
}

/// If walls are at the sides of a doorway's longer axis and not at its ends, its width is the shorter of its two
/// lengths. Returns both ends of the line across such a doorway, between its jambs; otherwise `None`. `solids` are those
/// near the doorway, other than the closed doorway itself.
pub(crate) fn jambs_of_narrow<'a>(
    doorway: &Doorway,
    solids: impl Iterator<Item = &'a Shape> + Clone,
) -> Option<[DVec2; 2]> {
    let (near, far, thickness) = doorway.shape.long_axis();
    let across = 0.5 * thickness * (far - near).normalize_or(DVec2::X).perp();
    let middle = 0.5 * (near + far);
    let touches = |p: DVec2| solids.clone().any(|solid| solid.distance(p) < TOUCH);
    let jambs = [middle - across, middle + across];
    (jambs.into_iter().all(touches) && !touches(near) && !touches(far)).then_some(jambs)
}
