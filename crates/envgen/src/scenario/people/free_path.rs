//! Paths between people, robots and leaves at their current positions, for people whom they hold up.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::TAU;

use glam::DVec2;

use super::free_space::{COSTS, FreeSpace, NEIGHBOURS};
use crate::geometry::{distance_between_segments, distance_to_segment, unit_vector};
use crate::scenario::doors::Leaf;
use crate::scenario::person::PERSON_RADIUS;

/// Half the side in cells of the window in which paths are searched.
const WINDOW: isize = 25;
const SIDE: usize = 2 * WINDOW as usize + 1;

/// The greatest number of columns and rows to the cell at which a path begins. If others and walls leave no such
/// cell, the path begins after a first step in one of so many directions.
const ENTRY: isize = 3;
const DIRECTIONS: u32 = 32;

/// The distance in metres by which a path may come nearer to what its beginning touches, due to rounding.
const ROUNDING: f64 = 1e-9;

/// The current positions of everything that may block a path.
pub(super) struct Blockers {
    /// The positions of the others, and the distance from each that the person must keep, in metres.
    pub(super) discs: Vec<(DVec2, f64)>,
    pub(super) leaves: Vec<Leaf>,
}

impl Blockers {
    /// Whether a person can walk from `a` to `b` in a straight line. A person who touches something at `a` may
    /// leave it.
    fn leave_free(&self, a: DVec2, b: DVec2) -> bool {
        let least = |needed: f64, now: f64| needed.min(now) - ROUNDING;
        self.discs
            .iter()
            .all(|&(p, needed)| distance_to_segment(p, a, b) >= least(needed, p.distance(a)))
            && self.leaves.iter().all(|leaf| {
                distance_between_segments(a, b, leaf.hinge, leaf.tip)
                    >= least(PERSON_RADIUS, leaf.nearest_point(a).distance(a))
            })
    }
}

/// Returns the shortest path on the grid from a point to a cell that is a goal: the cell, and the corners with the
/// last one first.
pub(super) fn free_path(
    space: &FreeSpace,
    from: DVec2,
    blockers: &Blockers,
    mut is_goal: impl FnMut(usize) -> bool,
) -> Option<(usize, Vec<DVec2>)> {
    let frame = space.frame;
    let here = frame.index_at(from)?;
    let (col, row) = frame.cell(here);
    let local = |cell: usize| {
        let (c, r) = frame.cell(cell);
        let (c, r) = (c as isize - col as isize + WINDOW, r as isize - row as isize + WINDOW);
        let inside = 0..SIDE as isize;
        (inside.contains(&c) && inside.contains(&r)).then(|| r as usize * SIDE + c as usize)
    };
    let is_clear = |a: DVec2, b: DVec2| space.is_squeezed_clear(a, b) && blockers.leave_free(a, b);
    let mut costs = vec![u32::MAX; SIDE * SIDE];
    let mut before = vec![usize::MAX; SIDE * SIDE];
    let mut first_steps = BTreeMap::new();
    let mut queue = BinaryHeap::new();
    let mut enter = |p: DVec2, walked: f64| {
        for up in -ENTRY..=ENTRY {
            for right in -ENTRY..=ENTRY {
                let Some(cell) = frame.neighbour(here, right, up) else { continue };
                let (Some(i), center) = (local(cell), frame.center_of(cell)) else { continue };
                let steps = (walked + p.distance(center)) / frame.cell_size;
                let cost = (f64::from(COSTS[0]) * steps) as u32;
                if cost < costs[i] && is_clear(p, center) {
                    costs[i] = cost;
                    queue.push(Reverse((cost, cell)));
                    if p != from {
                        first_steps.insert(cell, p);
                    }
                }
            }
        }
        !queue.is_empty()
    };
    if !enter(from, 0.0) {
        for k in 0..DIRECTIONS {
            let direction = unit_vector(TAU * f64::from(k) / f64::from(DIRECTIONS));
            for length in [frame.cell_size, 2.0 * frame.cell_size] {
                let p = from + length * direction;
                if is_clear(from, p) {
                    enter(p, length);
                }
            }
        }
    }
    while let Some(Reverse((cost, cell))) = queue.pop() {
        let Some(i) = local(cell) else { continue };
        if costs[i] != cost {
            continue;
        }
        if is_goal(cell) {
            let mut path = corners(cell, |cell| local(cell).map(|i| before[i]), space);
            let first = path.last().and_then(|&p| frame.index_at(p));
            path.extend(first.and_then(|cell| first_steps.get(&cell)));
            return Some((cell, path));
        }
        let center = frame.center_of(cell);
        for (direction, &(right, up)) in NEIGHBOURS.iter().enumerate() {
            let Some(other) = frame.neighbour(cell, right, up) else { continue };
            let Some(k) = local(other) else { continue };
            let there = cost + COSTS[direction % 2];
            if there < costs[k] && is_clear(center, frame.center_of(other)) {
                costs[k] = there;
                before[k] = cell;
                queue.push(Reverse((there, other)));
            }
        }
    }
    None
}

/// Returns the corners of the path to a cell, with the last one first.
fn corners(last: usize, before: impl Fn(usize) -> Option<usize>, space: &FreeSpace) -> Vec<DVec2> {
    let cells =
        std::iter::successors(Some(last), |&cell| before(cell).filter(|&cell| cell != usize::MAX));
    let mut corners: Vec<DVec2> = Vec::new();
    for p in cells.map(|cell| space.frame.center_of(cell)) {
        if let [.., a, b] = corners[..]
            && (b - a).perp_dot(p - b).abs() < ROUNDING
        {
            corners.pop();
        }
        corners.push(p);
    }
    corners
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::Provenance;
    use crate::clearance_index::ClearanceIndex;
    use crate::geometry::{Rect, Shape, edges};
    use crate::scenario::people::REACH;
    use crate::world::{Wall, WallKind, World};

    /// A room of 8 x 8 m.
    fn room() -> FreeSpace {
        let bounds = Rect::new(DVec2::ZERO, DVec2::splat(8.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        let corners = Shape::from_rect(bounds).corners();
        let wall = |(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b });
        world.walls = edges(&corners).map(wall).collect();
        let index = Arc::new(ClearanceIndex::new(&world, REACH).unwrap());
        FreeSpace::new(&world, &[], index)
    }

    fn path_away(space: &FreeSpace, from: DVec2, blockers: &Blockers) -> Option<Vec<DVec2>> {
        let is_away = |cell| space.frame.center_of(cell).distance(from) >= 2.0;
        free_path(space, from, blockers, is_away).map(|(_, path)| path)
    }

    #[test]
    fn who_is_pinned_leaves_by_the_only_gap() {
        let (space, from) = (room(), DVec2::new(4.03, 0.25));
        // At a wall, with others in front and beside; then on the other side as well.
        let beside = |angle: f64| (from + 0.5 * unit_vector(angle), 0.5);
        let discs = vec![beside(0.0), beside(0.25 * TAU)];
        let path = path_away(&space, from, &Blockers { discs: discs.clone(), leaves: Vec::new() });
        assert!(path.is_some_and(|path| path[0].x < from.x));
        let all = [discs, vec![beside(0.5 * TAU)]].concat();
        let blockers = Blockers { discs: all, leaves: Vec::new() };
        assert_eq!(path_away(&space, from, &blockers), None);
    }

    proptest! {
        #[test]
        fn paths_keep_away_from_everyone(
            from in [0.3..7.7, 0.3..7.7],
            others in prop::collection::vec([0.3..7.7, 0.3..7.7], 0..60),
            leaf in proptest::option::of([0.5..7.5, 0.5..7.5]),
        ) {
            let (space, from) = (room(), DVec2::from(from));
            let discs = others.into_iter().map(|p| (DVec2::from(p), 0.5)).collect();
            let leaves = leaf.map(|hinge| Leaf {
                hinge: DVec2::from(hinge),
                tip: DVec2::from(hinge) + DVec2::new(0.7, 0.4),
            });
            let blockers = Blockers { discs, leaves: leaves.into_iter().collect() };
            let Some(path) = path_away(&space, from, &blockers) else { return Ok(()) };
            let mut at = from;
            for &corner in path.iter().rev() {
                prop_assert!(corner.min_element() > 0.24 && corner.max_element() < 7.76);
                for &(p, needed) in &blockers.discs {
                    let now = needed.min(p.distance(at));
                    prop_assert!(distance_to_segment(p, at, corner) >= now - 1e-6);
                }
                for leaf in &blockers.leaves {
                    let now = PERSON_RADIUS.min(leaf.nearest_point(at).distance(at));
                    let found = distance_between_segments(at, corner, leaf.hinge, leaf.tip);
                    prop_assert!(found >= now - 1e-6);
                }
                at = corner;
            }
            prop_assert!(at.distance(from) >= 2.0);
        }
    }
}
