//! The rule whether a person may step where a door's leaves are or will be.

use glam::DVec2;

use crate::geometry::segments_cross;
use crate::scenario::PERSON_RADIUS;
use crate::scenario::doors::{DoorShape, DoorState, LEAF_GAP};

/// The distance in metres that people keep from the swing of a door that cannot open because of them.
pub(super) const OFF_SWINGS: f64 = PERSON_RADIUS + 2.0 * LEAF_GAP;

/// Whether a step touches no leaf of a door, and does not enter the space of moving leaves, or that of a closed
/// door to which the person goes. A person who is in the space of a door that waits to open may walk in it to leave
/// it.
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
    if state.is_still() && !goes_through {
        return true;
    }
    let distance = shape.swing_distance(to);
    if distance >= OFF_SWINGS {
        return true;
    }
    let before = shape.swing_distance(from);
    let waits = state.opens && before < OFF_SWINGS;
    distance >= before || (waits && !goes_through)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seed;
    use crate::geometry::{Rect, Shape};
    use crate::scenario::doors::{Door, DoorClock, DoorKind};
    use crate::scenario::spec::DoorControl;
    use crate::world::Doorway;

    const V: fn(f64, f64) -> DVec2 = DVec2::new;

    /// A door of 1 m along x with its hinge at the origin, whose leaf swings to +y.
    fn door(openness: f64, opens: bool) -> (DoorShape, DoorState) {
        let door = Door {
            doorway: 0,
            kind: DoorKind::Hinged,
            far_end: false,
            to_right: false,
            control: DoorControl::Commanded,
            open: 30.0,
            closed: 30.0,
            slam: 0.0,
        };
        let opening = Shape::from_rect(Rect::new(V(0.0, -0.1), V(1.0, 0.1)));
        let shape = DoorShape::new(&door, &Doorway::new(opening, true, [None, None]));
        let clock = DoorClock { seed: Seed(1), doorway: 0, tick: 0 };
        let mut state = DoorState::new(&door, &clock);
        (state.openness, state.opens) = (openness, opens);
        (shape, state)
    }

    fn passes(
        (shape, state): &(DoorShape, DoorState),
        step: [DVec2; 2],
        to: Option<DVec2>,
    ) -> bool {
        passes_door(shape, state, (step[0], step[1]), to)
    }

    #[test]
    fn only_who_holds_up_a_door_walks_in_the_swing_of_leaves_that_move() {
        // Beside the swing, nearer to it than a door can open, and into it, far from the leaf.
        let into = [V(-0.1, 0.8), V(-0.05, 0.8)];
        assert!(passes(&door(0.3, true), into, None), "it waits for the person");
        assert!(!passes(&door(0.7, false), into, None), "it closes");
        assert!(passes(&door(0.0, false), into, None), "it is closed");
        // From farther off nobody enters, and everybody may leave.
        let (far, near) = (V(-0.4, 0.8), V(-0.2, 0.8));
        assert!(!passes(&door(0.3, true), [far, near], None));
        assert!(passes(&door(0.3, true), [near, far], None));
        assert!(passes(&door(0.7, false), [near, far], None));
        // Who goes through waits off the swing.
        assert!(!passes(&door(0.3, true), into, Some(V(0.5, -1.0))));
    }

    #[test]
    fn who_goes_through_a_closed_door_waits_off_its_swing() {
        let closed = door(0.0, false);
        let (through, along) = (Some(V(0.5, -1.0)), Some(V(0.5, 0.6)));
        let step = [V(0.5, 1.1), V(0.5, 1.05)];
        assert!(!passes(&closed, step, through));
        assert!(passes(&closed, step, along) && passes(&closed, step, None));
        assert!(passes(&closed, [V(0.5, 1.4), V(0.5, 1.35)], through), "far enough");
    }

    #[test]
    fn nobody_walks_into_a_leaf() {
        // The leaf of the open door is on the y axis.
        let open = door(1.0, true);
        let through = Some(V(0.5, -1.0));
        assert!(passes(&open, [V(0.5, 0.5), V(0.45, 0.5)], through));
        assert!(!passes(&open, [V(0.27, 0.5), V(0.24, 0.5)], through));
        assert!(passes(&open, [V(0.20, 0.5), V(0.21, 0.5)], through), "away from it");
    }
}
