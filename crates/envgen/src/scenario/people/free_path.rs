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

/// A search for the shortest paths on the grid from a point between blockers. It is continued from goal to goal.
pub(super) struct FreePaths<'a> {
    space: &'a FreeSpace,
    blockers: &'a Blockers,
    /// Column and row of the cell in the middle of the window.
    middle: (usize, usize),
    /// For each cell of the window, the cost of the path to it, and the cell before it.
    costs: Vec<u32>,
    before: Vec<usize>,
    /// For a cell at which paths begin after a first step, the point to which that step leads.
    first_steps: BTreeMap<usize, DVec2>,
    queue: BinaryHeap<Reverse<(u32, usize)>>,
    /// The cells that were reached so far, with the nearest one first, and how many of them were searched from.
    reached: Vec<usize>,
    searched: usize,
}

impl<'a> FreePaths<'a> {
    /// Begins a search at a point; `None` outside the grid.
    pub(super) fn new(
        space: &'a FreeSpace,
        from: DVec2,
        blockers: &'a Blockers,
    ) -> Option<FreePaths<'a>> {
        let middle = space.frame.cell_at(from)?;
        let mut paths = FreePaths {
            space,
            blockers,
            middle,
            costs: vec![u32::MAX; SIDE * SIDE],
            before: vec![usize::MAX; SIDE * SIDE],
            first_steps: BTreeMap::new(),
            queue: BinaryHeap::new(),
            reached: Vec::new(),
            searched: 0,
        };
        paths.enter(from, None);
        if paths.queue.is_empty() {
            for k in 0..DIRECTIONS {
                let direction = unit_vector(TAU * f64::from(k) / f64::from(DIRECTIONS));
                for length in [space.frame.cell_size, 2.0 * space.frame.cell_size] {
                    let p = from + length * direction;
                    if paths.is_clear(from, p) {
                        paths.enter(p, Some(length));
                    }
                }
            }
        }
        Some(paths)
    }

    fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        self.space.is_squeezed_clear(a, b) && self.blockers.leave_free(a, b)
    }

    /// Returns the index in the window of a cell of the grid; `None` outside.
    fn local(&self, cell: usize) -> Option<usize> {
        let (c, r) = self.space.frame.cell(cell);
        let (col, row) = self.middle;
        let (c, r) = (c as isize - col as isize + WINDOW, r as isize - row as isize + WINDOW);
        let inside = 0..SIDE as isize;
        (inside.contains(&c) && inside.contains(&r)).then(|| r as usize * SIDE + c as usize)
    }

    /// Begins paths at the cells around the middle that are in sight of a point: the beginning, or one at the end of
    /// a first step of a length in metres.
    fn enter(&mut self, p: DVec2, first_step: Option<f64>) {
        let frame = self.space.frame;
        let here = frame.index(self.middle.0, self.middle.1);
        for up in -ENTRY..=ENTRY {
            for right in -ENTRY..=ENTRY {
                let Some(cell) = frame.neighbour(here, right, up) else { continue };
                let (Some(i), center) = (self.local(cell), frame.center_of(cell)) else { continue };
                let steps = (first_step.unwrap_or(0.0) + p.distance(center)) / frame.cell_size;
                let cost = (f64::from(COSTS[0]) * steps) as u32;
                if cost < self.costs[i] && self.is_clear(p, center) {
                    self.costs[i] = cost;
                    self.queue.push(Reverse((cost, cell)));
                    if first_step.is_some() {
                        self.first_steps.insert(cell, p);
                    }
                }
            }
        }
    }

    /// Returns the path to the nearest cell that is a goal: the cell, and the corners with the last one first.
    pub(super) fn to(
        &mut self,
        mut is_goal: impl FnMut(usize) -> bool,
    ) -> Option<(usize, Vec<DVec2>)> {
        let mut at = 0;
        loop {
            let cell = match self.reached.get(at) {
                Some(&cell) => cell,
                None => self.reach_next()?,
            };
            if is_goal(cell) {
                let before = |cell| self.local(cell).map(|i| self.before[i]);
                let mut path = corners(cell, before, self.space);
                let first = path.last().and_then(|&p| self.space.frame.index_at(p));
                path.extend(first.and_then(|cell| self.first_steps.get(&cell)));
                return Some((cell, path));
            }
            at += 1;
        }
    }

    /// Returns the nearest cell that was not reached yet.
    fn reach_next(&mut self) -> Option<usize> {
        while let Some(&cell) = self.reached.get(self.searched) {
            self.search_from(cell);
            self.searched += 1;
        }
        while let Some(Reverse((cost, cell))) = self.queue.pop() {
            if self.local(cell).is_some_and(|i| self.costs[i] == cost) {
                self.reached.push(cell);
                return Some(cell);
            }
        }
        None
    }

    fn search_from(&mut self, cell: usize) {
        let frame = self.space.frame;
        let Some(cost) = self.local(cell).map(|i| self.costs[i]) else { return };
        let center = frame.center_of(cell);
        for (direction, &(right, up)) in NEIGHBOURS.iter().enumerate() {
            let Some(other) = frame.neighbour(cell, right, up) else { continue };
            let Some(k) = self.local(other) else { continue };
            let there = cost + COSTS[direction % 2];
            if there >= self.costs[k] {
                continue;
            }
            let end = frame.center_of(other);
            let is_clear = self.space.is_squeezed_clear_move(cell, direction, (center, end));
            if is_clear && self.blockers.leave_free(center, end) {
                self.costs[k] = there;
                self.before[k] = cell;
                self.queue.push(Reverse((there, other)));
            }
        }
    }
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
    use crate::geometry::{Rect, Shape, edges};
    use crate::scenario::people::index_solids;
    use crate::world::{Wall, WallKind, World};

    /// A room of 8 x 8 m.
    fn room() -> FreeSpace {
        let bounds = Rect::new(DVec2::ZERO, DVec2::splat(8.0));
        let mut world = World::new(Provenance::other("test", serde_json::Value::Null), bounds);
        let corners = Shape::from_rect(bounds).corners();
        let wall = |(a, b)| Wall::new(WallKind::Wall, Shape::Segment { a, b });
        world.walls = edges(&corners).map(wall).collect();
        let index = Arc::new(index_solids(&world).unwrap());
        FreeSpace::new(&world, &[], index)
    }

    fn path_away(space: &FreeSpace, from: DVec2, blockers: &Blockers) -> Option<Vec<DVec2>> {
        let is_away = |cell| space.frame.center_of(cell).distance(from) >= 2.0;
        FreePaths::new(space, from, blockers)?.to(is_away).map(|(_, path)| path)
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
            let found = path_away(&space, from, &blockers);
            // A search that was continued to another goal finds the same.
            let mut paths = FreePaths::new(&space, from, &blockers).unwrap();
            let is_far = |cell| space.frame.center_of(cell).distance(from) >= 4.0;
            let far = paths.to(is_far);
            let is_away = |cell| space.frame.center_of(cell).distance(from) >= 2.0;
            prop_assert_eq!(&paths.to(is_away).map(|(_, path)| path), &found);
            prop_assert_eq!(paths.to(is_far), far.clone());
            prop_assert_eq!(FreePaths::new(&space, from, &blockers).unwrap().to(is_far), far);
            let Some(path) = found else { return Ok(()) };
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
