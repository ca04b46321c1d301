//! Chains of overlapping free discs from one point to another. Such a chain proves that a disc can pass where too
//! many pieces are near each other to be compared in pairs, at a cost that depends on the path.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::TAU;

use glam::DVec2;

use super::budget::{Budget, Doubt, MAX_BUBBLES};
use super::piece_index::Pieces;
use crate::geometry::{Rect, Shape};

/// The greatest radius of a bubble, as a share of the disc's.
const MOST: f64 = 0.5;

/// The least radius of the bubbles that begin at an end, and of all others, as shares of the disc's radius. The
/// claims of generators leave a fifth of half the width of hallways and roads.
const LEAST: f64 = 1e-3;
const SPARE: f64 = 0.05;

/// The distance between the points of a bubble's border from which others grow, as a share of the disc's radius.
const SPACING: f64 = 0.1;

/// The least number of such points.
const LEAST_POINTS: usize = 8;

/// A point within this share of a bubble's radius is inside the bubble, whatever the rounding errors are.
const INSIDE: f64 = 1.0 - 1e-6;

/// A point within this share of a bubble's radius needs no bubble of its own.
const COVERED: f64 = 0.99;

/// The cost of a bubble, in addition to the comparisons with pieces.
const BUBBLE_COST: u64 = 4;

/// The free space of a disc, around which other discs of the path are sought.
pub(super) struct Bubbles {
    pieces: Pieces,
    area: Rect,
    radius: f64,
}

/// A disc of points that are all free for the moving disc's centre.
#[derive(Clone, Copy, Debug)]
struct Bubble {
    middle: DVec2,
    radius: f64,
    /// Which of the two ends the bubble is joined to.
    end: usize,
}

/// A bubble that may be added, the largest first.
#[derive(Clone, Copy, Debug)]
struct Growth {
    radius: f64,
    middle: DVec2,
}

/// The result of adding a bubble.
enum Added {
    /// Its centre lies inside other bubbles of its end.
    Covered,
    /// It overlaps a bubble of the other end.
    Joins,
    /// Neither of these.
    Alone,
}

/// The bubbles by the cell of their centre. Cells are as wide as the largest bubble.
struct Found {
    side: f64,
    cells: BTreeMap<[i64; 2], Vec<Bubble>>,
    count: usize,
}

impl Bubbles {
    /// Creates the free space of a disc whose centre lies inside `area`. `radius` must be above 0.
    pub(super) fn new<'a>(
        shapes: impl Iterator<Item = Cow<'a, Shape>>,
        area: Rect,
        radius: f64,
    ) -> Result<Self, Doubt> {
        Ok(Bubbles { pieces: Pieces::new(shapes, (1.0 + MOST) * radius)?, area, radius })
    }

    /// Whether a path is found between two points that lie in the area and outside all shapes. Bubbles grow from
    /// both points, the largest first, until two of them overlap.
    pub(super) fn join(&self, ends: [DVec2; 2], budget: &mut Budget) -> Result<bool, Doubt> {
        let side = 2.0 * MOST * self.radius;
        let mut found = Found { side, cells: BTreeMap::new(), count: 0 };
        let mut open = [BinaryHeap::new(), BinaryHeap::new()];
        for (end, &middle) in ends.iter().enumerate() {
            let radius = self.spare(middle, budget)?;
            if radius < LEAST * self.radius {
                return Ok(false);
            }
            open[end].push(Growth { radius, middle });
        }
        loop {
            for (end, open) in open.iter_mut().enumerate() {
                let Some(Growth { radius, middle }) = open.pop() else { return Ok(false) };
                match found.add(Bubble { middle, radius, end }, budget)? {
                    Added::Joins => return Ok(true),
                    Added::Covered => continue,
                    Added::Alone => {}
                }
                let count = (TAU * radius / (SPACING * self.radius)).ceil() as usize;
                let count = count.max(LEAST_POINTS);
                for i in 0..count {
                    let (sin, cos) = libm::sincos(TAU * i as f64 / count as f64);
                    let middle = middle + INSIDE * radius * DVec2::new(cos, sin);
                    if !self.area.contains(middle) || found.cover(middle, end, budget)? {
                        continue;
                    }
                    let next = self.spare(middle, budget)?;
                    // A small one is of use only where it leads to larger ones.
                    if next >= SPARE * self.radius || next > radius {
                        open.push(Growth { radius: next, middle });
                    }
                }
            }
        }
    }

    /// Returns how far the disc's centre can be moved in every direction inside the area. Because the area is
    /// convex, a bubble's part in it is connected, and so are two bubbles that overlap.
    fn spare(&self, p: DVec2, budget: &mut Budget) -> Result<f64, Doubt> {
        Ok((self.pieces.clearance(p, budget)? - self.radius).min(MOST * self.radius))
    }
}

impl Found {
    fn cell(&self, p: DVec2) -> [i64; 2] {
        [(p.x / self.side).floor() as i64, (p.y / self.side).floor() as i64]
    }

    /// Returns the bubbles in the cell of a point and in the cells around it.
    fn near(&self, p: DVec2) -> impl Iterator<Item = &Bubble> {
        let [col, row] = self.cell(p);
        let cells = (-1..=1).flat_map(move |i| {
            (-1..=1).map(move |j| [col.saturating_add(i), row.saturating_add(j)])
        });
        cells.filter_map(|cell| self.cells.get(&cell)).flatten()
    }

    /// Whether a point is well inside a bubble of an end.
    fn cover(&self, p: DVec2, end: usize, budget: &mut Budget) -> Result<bool, Doubt> {
        let mut compared = BUBBLE_COST;
        let mut near = self.near(p).inspect(|_| compared += 1);
        let covers = near.any(|b| b.end == end && b.middle.distance(p) < COVERED * b.radius);
        drop(near);
        budget.spend(compared)?;
        Ok(covers)
    }

    fn add(&mut self, bubble: Bubble, budget: &mut Budget) -> Result<Added, Doubt> {
        let Bubble { middle, radius, end } = bubble;
        if self.cover(middle, end, budget)? {
            return Ok(Added::Covered);
        }
        let overlaps =
            |b: &Bubble| b.end != end && b.middle.distance(middle) < INSIDE * (b.radius + radius);
        if self.near(middle).any(overlaps) {
            return Ok(Added::Joins);
        }
        if self.count == MAX_BUBBLES {
            return Err(Doubt::Comparisons);
        }
        self.count += 1;
        self.cells.entry(self.cell(middle)).or_default().push(bubble);
        Ok(Added::Alone)
    }
}

impl PartialEq for Growth {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Growth {}

impl PartialOrd for Growth {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Growth {
    fn cmp(&self, other: &Self) -> Ordering {
        self.radius.total_cmp(&other.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::super::disc_path::Barriers;
    use super::super::disc_path::tests::{SIDE, shapes};
    use super::*;
    use proptest::prelude::*;

    fn joins(shapes: &[Shape], area: Rect, radius: f64, ends: [DVec2; 2]) -> bool {
        let budget = &mut Budget::new(u64::MAX);
        let bubbles = Bubbles::new(shapes.iter().map(Cow::Borrowed), area, radius).unwrap();
        bubbles.join(ends, budget).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]
        #[test]
        fn what_has_room_to_spare_passes(
            shapes in shapes(),
            radius in 0.01..0.6_f64,
            ends in prop::array::uniform4(0.0..=SIDE),
        ) {
            let area = Rect::new(DVec2::ZERO, DVec2::splat(SIDE));
            let ends = [DVec2::new(ends[0], ends[1]), DVec2::new(ends[2], ends[3])];
            let is_free = |p: DVec2| shapes.iter().all(|shape| shape.distance(p) > radius + 1e-6);
            prop_assume!(ends.into_iter().all(is_free));
            let exact = |radius: f64| {
                let pieces = Pieces::new(shapes.iter(), radius).unwrap();
                Barriers::new(&pieces, area, radius).join(&[ends], &mut Budget::new(u64::MAX))
            };
            let found = joins(&shapes, area, radius, ends);
            prop_assert!(!found || exact(radius) == Ok(true));
            // Where a larger disc passes from within the area, this one has the room.
            let larger = (1.0 + 0.2) * radius;
            let inner = area.grown(radius - larger);
            let is_roomy = |p: DVec2| {
                inner.contains(p) && shapes.iter().all(|shape| shape.distance(p) > larger)
            };
            if ends.into_iter().all(is_roomy) {
                let pieces = Pieces::new(shapes.iter(), larger).unwrap();
                let barriers = Barriers::new(&pieces, inner, larger);
                if barriers.join(&[ends], &mut Budget::new(u64::MAX)) == Ok(true) {
                    prop_assert!(found);
                }
            }
        }
    }

    #[test]
    fn bubbles_grow_from_ends_at_the_border() {
        // A corridor of 1 m that begins and ends at the area's sides.
        let wall = |y: f64| Shape::Segment { a: DVec2::new(-1.0, y), b: DVec2::new(9.0, y) };
        let walls = [wall(0.0), wall(1.0)];
        let area = Rect::new(DVec2::new(0.0, -1.0), DVec2::new(8.0, 2.0));
        let ends = [DVec2::new(0.0, 0.5), DVec2::new(8.0, 0.5)];
        assert!(joins(&walls, area, 0.4, ends));
        assert!(joins(&walls, area, 0.45, ends));
        // Hardly any room to spare.
        assert!(!joins(&walls, area, 0.495, ends));
        assert!(!joins(&walls, area, 0.4, [ends[0], DVec2::new(4.0, 1.5)]));
        let bollard = Shape::Disc { center: DVec2::new(4.0, 0.5), radius: 0.1 };
        assert!(!joins(&[walls[0].clone(), walls[1].clone(), bollard], area, 0.4, ends));
    }
}
