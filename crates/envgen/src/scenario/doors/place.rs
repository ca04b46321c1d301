//! The choice of doorways that have doors, and of the directions in which their leaves can swing.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use glam::DVec2;

use super::door::{Door, DoorKind};
use super::free_space::{FreeSpace, clears};
use super::leaf::{DoorShape, Leaf};
use crate::doorways::{jambs_of_narrow, near_middles};
use crate::error::SpecError;
use crate::geometry::{Rect, Shape, edges, polygon_contains, segments_cross};
use crate::grid::GridIndex;
use crate::scenario::person::PERSON_RADIUS;
use crate::scenario::spec::{DoorKinds, ScenarioSpec};
use crate::seed::Seed;
use crate::world::{Claim, Doorway, Extent, PartId, Solid, World};

/// The distance in metres that leaves keep from solids in front of their wall.
const GAP: f64 = 0.02;

/// The least radius in metres of a disc for which open leaves leave the free space connected: a person with some room.
const PERSON_WITH_ROOM: f64 = PERSON_RADIUS + 0.05;

/// Draws the doors of a world. Each doorway has its own random stream, so that adding or removing a doorway does
/// not change any other door.
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
    let promised = promised_radius(world);
    let around = Around::new(world, promised);
    // What the leaves of each doorway sweep, and where they are when they are open.
    let mut swept: Vec<Vec<(Rect, Shape)>> = vec![Vec::new(); world.doorways.len()];
    let mut open_leaves: Vec<Vec<Leaf>> = vec![Vec::new(); world.doorways.len()];
    let mut doors = Vec::new();
    for (i, doorway) in world.doorways.iter().enumerate().filter(|(_, doorway)| doorway.open) {
        let mut stream = seed.stream("scenario/doors", i as u64);
        if !stream.chance(spec.doors) {
            continue;
        }
        // A leaf along its longer axis would stand in the passage.
        let solids_near = around.solids_near(doorway).map(|(solid, _)| &solid.1);
        if jambs_of_narrow(doorway, solids_near).is_some() {
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
        let (.., thickness) = doorway.shape.long_axis();
        let half_wall = 0.5 * thickness;
        let outlines = |door: &Door| DoorShape::new(door, doorway).swept_outlines(half_wall + GAP);
        let others = || around.openings_near(doorway).filter(|j| *j != i);
        let is_free = |door: &Door| {
            outlines(door).iter().all(|outline| {
                let is_opening = |j: usize| {
                    let other = &world.doorways[j].shape;
                    meets(outline, other.bounds(), other)
                };
                let mut leaves = others().flat_map(|j| &swept[j]);
                !around.solids_near(doorway).any(|(solid, _)| meets(outline, solid.0, &solid.1))
                    && !others().any(is_opening)
                    && !leaves.any(|(bounds, shape)| meets(outline, *bounds, shape))
            })
        };
        let solids = || around.solids_near(doorway).map(|(solid, _)| solid);
        let leaves = || others().flat_map(|j| open_leaves[j].iter().copied());
        let spaces = OnceCell::new();
        let (reach, radii) = surroundings(doorway, promised);
        let leaves_room = |door: &Door| {
            let open: Vec<Leaf> = DoorShape::new(door, doorway).leaves(1.0).collect();
            if open.is_empty() {
                return true;
            }
            let spaces: &Option<Vec<FreeSpace>> = spaces.get_or_init(|| {
                let middle = doorway.shape.bounds().center();
                let space = |&radius| FreeSpace::new((middle, reach), solids(), leaves(), radius);
                radii.iter().map(space).collect()
            });
            let mut ends = [world.start, world.goal].into_iter().flatten();
            ends.all(|end| clears(&open, end.position, radii[0]))
                && spaces
                    .as_ref()
                    .is_some_and(|spaces| spaces.iter().all(|space| space.stays_connected(&open)))
        };
        let mut candidates = candidates.peekable();
        let Some(&any) = candidates.peek() else { continue };
        let door = candidates
            .find(|door| is_free(door) && leaves_room(door))
            .unwrap_or(Door { kind: DoorKind::Sliding, ..any });
        // No leaf passes what is in a wide doorway, such as clutter.
        let leaf = middle_of_leaf(&door, doorway);
        let mut low = around.solids_near(doorway).filter(|(_, is_low)| *is_low);
        if door.kind == DoorKind::Sliding && low.any(|(solid, _)| meets(&leaf, solid.0, &solid.1)) {
            continue;
        }
        open_leaves[i] = DoorShape::new(&door, doorway).leaves(1.0).collect();
        swept[i] = outlines(&door)
            .into_iter()
            .map(|vertices| {
                let shape = Shape::Polygon { vertices };
                (shape.bounds(), shape)
            })
            .collect();
        doors.push(door);
    }
    Ok(doors)
}

/// The surroundings of open doorways.
struct Around {
    solids: Vec<(Rect, Shape)>,
    /// For each solid, whether it is at the height of a doorway and not only above or below all doorways.
    is_low: Vec<bool>,
    near_solids: GridIndex,
    near_openings: GridIndex,
}

impl Around {
    fn new(world: &World, promised: f64) -> Self {
        let bounds_of = |solid: Solid<'_>| (solid.shape.bounds(), solid.shape.into_owned());
        let solids: Vec<(Rect, Shape)> = world.solids().map(bounds_of).collect();
        let open = world.doorways.iter().filter(|doorway| doorway.open);
        let extents = open.map(Doorway::extent);
        let all = extents
            .reduce(|a, b| Extent::between(a.bottom().min(b.bottom()), a.top().max(b.top())));
        let low: BTreeSet<PartId> = all.map_or_else(BTreeSet::new, |all| {
            world.solids_within(all).map(|solid| solid.id).collect()
        });
        let is_low = world.solids().map(|solid| low.contains(&solid.id)).collect();
        let near_solids =
            near_doorways(world, solids.iter().map(|(bounds, _)| *bounds), (promised, 1.0));
        let openings = world.doorways.iter().map(|doorway| doorway.shape.bounds());
        let near_openings = near_doorways(world, openings, (promised, 2.0));
        Around { solids, is_low, near_solids, near_openings }
    }

    /// Returns the solids that the leaves of a doorway can meet, each with whether it is at the height of doorways.
    fn solids_near(
        &self,
        doorway: &Doorway,
    ) -> impl Iterator<Item = (&(Rect, Shape), bool)> + Clone {
        let near = self.near_solids.at(doorway.shape.bounds().center()).iter();
        near.map(|&i| (&self.solids[i as usize], self.is_low[i as usize]))
    }

    /// Returns the doorways whose leaves can meet those of a doorway, including this doorway.
    fn openings_near(&self, doorway: &Doorway) -> impl Iterator<Item = usize> {
        let near = self.near_openings.at(doorway.shape.bounds().center()).iter();
        near.map(|&i| i as usize)
    }
}

/// Whether an outline and a shape with these bounds overlap.
fn meets(outline: &[DVec2], bounds: Rect, shape: &Shape) -> bool {
    let around = Rect::around(outline.iter().copied());
    around.is_some_and(|around| around.overlaps(bounds)) && overlap(outline, shape)
}

/// Returns the greatest radius of the discs that can move through the world by its promises; 0 without such promises.
fn promised_radius(world: &World) -> f64 {
    let radii = world.certificate.iter().filter_map(|claim| match claim {
        Claim::Connected { radius } | Claim::EveryPlaceReachable { radius } => Some(*radius),
        _ => None,
    });
    radii.fold(0.0, f64::max)
}

/// Returns how far from the middle of a doorway its open leaves may part the free space, in metres along each axis, and
/// the radii of the discs for which they must not: a disc of the promised radius, if it fits through, and a person unless
/// that disc is larger.
fn surroundings(doorway: &Doorway, promised: f64) -> (f64, Vec<f64>) {
    let (from, to, _) = doorway.shape.long_axis();
    let width = from.distance(to);
    let promised = promised.min(width);
    let mut radii = vec![promised.max(PERSON_WITH_ROOM)];
    if promised > 0.0 && promised < PERSON_WITH_ROOM {
        radii.push(promised);
    }
    (1.2 * width + 2.5 * radii[0] + 0.2, radii)
}

/// Indexes, for the middle of each open doorway, the numbers of the bounds that are within a multiple of the reach
/// of the largest door, and perhaps some farther ones.
fn near_doorways(
    world: &World,
    bounds: impl Iterator<Item = Rect>,
    (promised, times): (f64, f64),
) -> GridIndex {
    let open = || world.doorways.iter().filter(|doorway| doorway.open);
    let reach = |doorway: &Doorway| {
        // The farthest corner of the free space around a doorway, and the disc there.
        let (reach, radii) = surroundings(doorway, promised);
        std::f64::consts::SQRT_2 * reach + radii[0]
    };
    near_middles(open(), bounds, times * open().map(reach).fold(0.0, f64::max))
}

/// Returns the middle half of a door's closed leaf. The ends of the leaf may touch jambs, or extend into them.
fn middle_of_leaf(door: &Door, doorway: &Doorway) -> Vec<DVec2> {
    let [a, b] = DoorShape::new(door, doorway).ends;
    Shape::thick_segment(a.lerp(b, 0.25), a.lerp(b, 0.75), GAP, 0.0).corners()
}

impl DoorKinds {
    /// Returns the kind of a door for a drawn number from 0 to 2.
    fn kind(self, draw: u64) -> DoorKind {
        match (self, draw) {
            (DoorKinds::Hinged, _) | (DoorKinds::Mixed, 0) => DoorKind::Hinged,
            (DoorKinds::Double, _) | (DoorKinds::Mixed, 1) => DoorKind::Double,
            _ => DoorKind::Sliding,
        }
    }
}

/// Whether a simple polygon and a shape have a point in common.
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
