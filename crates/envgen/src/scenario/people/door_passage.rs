//! Whether a person may step where a door's leaves are or will be.

use glam::DVec2;

use crate::geometry::segments_cross;
use crate::scenario::PERSON_RADIUS;
use crate::scenario::door::{DoorShape, DoorState, LEAF_GAP};

/// People keep this far from the swing of a door that cannot open because of them, in metres.
pub(super) const OFF_SWINGS: f64 = PERSON_RADIUS + 2.0 * LEAF_GAP;

/// Whether a step touches no leaf of a door, and does not enter the space of leaves that move, or of a closed
/// door to which the person goes. Who is in the space of a door that waits to open may walk in it to leave it.
pub(super) fn passes_door(
    shape: &DoorShape,
    state: &DoorState,
    (from, to): (DVec2, DVec2),
    corner: Option<DVec2>,
) -> bool {
    let is_off_leaves = state.leaves(shape).all(|leaf| {
        let distance = leaf.nearest_point(to).distance(to);
        distance >= PERSON_RADIUS || distance > leaf.nearest_point(from).distance(from)
    });
    if !is_off_leaves || state.is_open() {
        return is_off_leaves;
    }
    let [a, b] = shape.ends;
    let goes_through = corner.is_some_and(|corner| segments_cross(from, corner, a, b));
    let (distance, before) = (shape.swing_distance(to), shape.swing_distance(from));
    let waits = state.opens && before < OFF_SWINGS;
    ((state.is_still() || waits) && !goes_through) || distance >= OFF_SWINGS || distance >= before
}
