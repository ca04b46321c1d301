//! Which doorways have doors, and where their leaves can swing.

use glam::DVec2;

use super::door::{Door, DoorKind};
use super::leaf::{DoorShape, Leaf};
use crate::error::SpecError;
use crate::geometry::{Rect, Shape, edges, polygon_contains, segments_cross};
use crate::scenario::person::PERSON_RADIUS;
use crate::scenario::spec::{DoorKinds, ScenarioSpec};
use crate::seed::Seed;
use crate::world::{Doorway, World};

/// Leaves keep this distance in metres from solids in front of their wall.
const GAP: f64 = 0.02;

/// Between an open leaf and the next solid is room for a person, in metres.
const PASSAGE: f64 = 2.0 * PERSON_RADIUS + 0.1;

/// Draws the doors of a world. Each doorway has a stream of its own, so that a doorway more or less changes
/// no other door.
pub(crate) fn place_doors(
    world: &World,
    spec: &ScenarioSpec,
    seed: Seed,
) -> Result<Vec<Door>, SpecError> {
    if spec.doors == 0.0 {
        return Ok(Vec::new());
    }
    if !world.doorways.iter().any(|doorway| doorway.open) {
        let why = "0: the world has no open doorway";
        return Err(ScenarioSpec::setting("doors").error_with(spec.doors, why));
    }
    let solids: Vec<(Rect, Shape)> =
        world.solids().map(|solid| (solid.shape.bounds(), solid.shape.into_owned())).collect();
    let mut swept: Vec<(Rect, Shape)> = Vec::new();
    let mut doors = Vec::new();
    for (i, doorway) in world.doorways.iter().enumerate().filter(|(_, doorway)| doorway.open) {
        let mut stream = seed.stream("scenario/doors", i as u64);
        if !stream.chance(spec.doors) {
            continue;
        }
        let kind = spec.door_kind.kind(stream.below(3));
        let first = stream.below(4);
        let candidates = (0..4).map(|turn| (first + turn) % 4).map(|corner| Door {
            doorway: i as u32,
            kind,
            far_end: corner % 2 == 1,
            to_right: corner / 2 == 1,
            control: spec.door_control,
            open: spec.door_open,
            closed: spec.door_closed,
            slam: spec.slam,
        });
        let half_wall = 0.5 * doorway.shape.bounds().size().min_element();
        let outlines = |door: &Door| DoorShape::new(door, doorway).swept_outlines(half_wall + GAP);
        let others = || world.doorways.iter().enumerate().filter(|(j, _)| *j != i);
        let is_free = |door: &Door| {
            outlines(door).iter().chain(&passages(door, doorway)).all(|outline| {
                let around = Rect::around(outline.iter().copied());
                let hits = |bounds: Rect, shape: &Shape| {
                    around.is_some_and(|around| around.overlaps(bounds)) && overlap(outline, shape)
                };
                !solids.iter().chain(&swept).any(|(bounds, shape)| hits(*bounds, shape))
                    && !others().any(|(_, other)| hits(other.shape.bounds(), &other.shape))
            })
        };
        let mut candidates = candidates.peekable();
        let Some(&any) = candidates.peek() else { continue };
        let door = candidates.find(is_free).unwrap_or(Door { kind: DoorKind::Sliding, ..any });
        swept.extend(outlines(&door).into_iter().map(|vertices| {
            let shape = Shape::Polygon { vertices };
            (shape.bounds(), shape)
        }));
        doors.push(door);
    }
    Ok(doors)
}

impl DoorKinds {
    /// The kind of a door by a draw from 0 to 2.
    fn kind(self, draw: u64) -> DoorKind {
        match (self, draw) {
            (DoorKinds::Hinged, _) | (DoorKinds::Mixed, 0) => DoorKind::Hinged,
            (DoorKinds::Double, _) | (DoorKinds::Mixed, 1) => DoorKind::Double,
            _ => DoorKind::Sliding,
        }
    }
}

/// What must be free beyond the open leaves so that someone can walk past them.
fn passages(door: &Door, doorway: &Doorway) -> Vec<Vec<DVec2>> {
    let shape = DoorShape::new(door, doorway);
    let passage = |Leaf { hinge, tip }: Leaf| {
        let beyond = tip + (tip - hinge).normalize_or_zero() * PASSAGE;
        Shape::thick_segment(tip, beyond, GAP, 0.0).corners()
    };
    shape.leaves(1.0).filter(|_| shape.swings()).map(passage).collect()
}

/// Whether a simple polygon and a shape share a point.
fn overlap(outline: &[DVec2], shape: &Shape) -> bool {
    if let Shape::Disc { center, radius } = shape {
        let near = edges(outline)
            .any(|(a, b)| crate::geometry::distance_to_segment(*center, a, b) <= *radius);
        return near || polygon_contains(outline, *center);
    }
    let corners = shape.corners();
    let crossed =
        edges(outline).any(|(a, b)| edges(&corners).any(|(c, d)| segments_cross(a, b, c, d)));
    let within = |p: Option<&DVec2>| p.is_some_and(|&p| polygon_contains(outline, p));
    crossed || within(corners.first()) || outline.first().is_some_and(|&p| shape.contains(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlaps_by_hand() {
        let v = DVec2::new;
        let square = [v(0., 0.), v(1., 0.), v(1., 1.), v(0., 1.)];
        let disc = |x, radius| Shape::Disc { center: v(x, 0.5), radius };
        assert!(overlap(&square, &disc(1.2, 0.3)) && overlap(&square, &disc(0.5, 0.1)));
        assert!(overlap(&square, &disc(0.5, 9.0)) && !overlap(&square, &disc(1.2, 0.1)));
        let rect = |a: f64, b: f64| Shape::from_rect(Rect::new(v(a, a), v(b, b)));
        assert!(overlap(&square, &rect(0.2, 0.4)) && overlap(&square, &rect(-1.0, 2.0)));
        assert!(overlap(&square, &rect(0.9, 2.0)) && !overlap(&square, &rect(1.1, 2.0)));
        assert!(overlap(&square, &Shape::Segment { a: v(-1., 0.5), b: v(2., 0.6) }));
        assert!(!overlap(&square, &Shape::Segment { a: v(-1., 1.5), b: v(2., 1.6) }));
    }
}
