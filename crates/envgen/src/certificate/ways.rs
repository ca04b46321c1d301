//! Whether a disc can move from one place to another: a flood over a lattice of points, each with
//! its exact distance to the nearest solid part.

use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec2, I64Vec2};

use super::Verdict;
use crate::geometry::{Rect, Shape};
use crate::lattice::{Convex, Lattice, Lists};
use crate::world::World;

/// The most lattice points that a flood looks at.
pub(super) const MOST_POINTS: u64 = 1 << 27;

/// The most cells of the index of shapes.
const MOST_CELLS: f64 = (1 << 22) as f64;

/// From where to where.
pub(super) enum Ends {
    /// Between two points.
    Points(DVec2, DVec2),
    /// From the area's west side to its east side.
    WestToEast,
}

/// Whether a disc's middle can move between two ends inside an area.
///
/// Every point of the plane lies within h / sqrt 2 of a point of a lattice of side h, and moving by
/// a step changes the distance to the nearest solid by no more than the step. So lattice points
/// with a distance of radius + h / sqrt 2 and more make a way for certain, and a way for certain
/// leads past lattice points of radius - h / sqrt 2 and more. The lattice is made finer until one
/// of the two decides, and only what the flood reaches is ever looked at.
pub(super) fn decide(
    world: &World,
    area: Rect,
    radius: f64,
    claimed: bool,
    ends: &Ends,
) -> Verdict {
    let size = area.size();
    let verdict = |way: bool| if way == claimed { Verdict::Holds } else { Verdict::Broken };
    // A third of the radius decides corridors a fifth wider than the disc.
    let mut h = (radius / 3.0).min(0.25 * size.min_element());
    if !(h > 0.0 && h.is_finite()) {
        return Verdict::Undecided;
    }
    let mut budget = MOST_POINTS;
    loop {
        // The points fill the area's width exactly, so that both sides have a column.
        let shapes = world.solids().map(|solid| solid.shape.into_owned()).collect();
        let flood = Flood::new(shapes, area, size.x / (size.x / h).ceil(), radius);
        match flood.joins(ends, flood.sure(radius), true, &mut budget) {
            None => return Verdict::Undecided,
            Some(true) => return verdict(true),
            Some(false) => {}
        }
        if let Some(distance) = flood.maybe(radius) {
            match flood.joins(ends, distance, false, &mut budget) {
                None => return Verdict::Undecided,
                Some(false) => return verdict(false),
                Some(true) => {}
            }
        }
        h *= 0.5;
    }
}

/// A lattice of points over an area, and the shapes that keep a disc away.
pub(super) struct Flood {
    area: Rect,
    h: f64,
    /// The shapes that can be within reach of a point, by the point's cell.
    near: Lists<u32>,
    lattice: Lattice,
    shapes: Vec<Shape>,
}

impl Flood {
    pub(super) fn new(shapes: Vec<Shape>, area: Rect, h: f64, radius: f64) -> Self {
        let reach = radius + 2.0 * h;
        let around = area.grown(2.0 * h);
        let size = around.size();
        let even = (size.x * size.y / (shapes.len() as f64 + 1.0)).sqrt();
        let side = even.max(reach).max((size.x * size.y / MOST_CELLS).sqrt());
        let cells = (size / side).ceil().max(DVec2::ONE);
        let (cols, rows) = (cells.x as usize, cells.y as usize);
        let lattice = Lattice { origin: around.min, side, cols, rows };
        let numbers: Vec<u32> = (0..shapes.len() as u32).collect();
        let near = Lists::build(&lattice, &numbers, None, |&i, lattice, visit| {
            let grown = Shape::from_rect(shapes[i as usize].bounds().grown(reach));
            lattice.touched_runs(&Convex::Polygon(&grown.corners()), visit);
        });
        Flood { area, h, near: near.unwrap_or_default(), lattice, shapes }
    }

    /// The distance at which lattice points make a way for a disc for certain.
    pub(super) fn sure(&self, radius: f64) -> f64 {
        radius + self.h * FRAC_1_SQRT_2
    }

    /// The distance of the lattice points that any way of a disc leads past; `None` where the
    /// lattice is too coarse to tell.
    pub(super) fn maybe(&self, radius: f64) -> Option<f64> {
        let distance = (radius - self.h * FRAC_1_SQRT_2) * (1.0 - 1e-9);
        (distance > 0.0).then_some(distance)
    }

    fn point(&self, at: I64Vec2) -> DVec2 {
        self.area.min + at.as_dvec2() * self.h
    }

    /// The lattice point nearest to a place: a step of h / sqrt 2 at most away.
    pub(super) fn nearest(&self, p: DVec2) -> I64Vec2 {
        ((p - self.area.min) / self.h).round().as_i64vec2()
    }

    /// Whether a point is at least `distance` away from all shapes.
    pub(super) fn is_clear(&self, at: I64Vec2, distance: f64) -> bool {
        let p = self.point(at);
        let near = self.lattice.cell_at(p).map_or(&[][..], |cell| self.near.of(cell));
        near.iter().all(|&i| self.shapes[i as usize].distance(p) >= distance)
    }

    /// The lattice points inside a shape, row by row.
    pub(super) fn points_in<'a>(&'a self, shape: &'a Shape) -> impl Iterator<Item = I64Vec2> + 'a {
        let bounds = shape.bounds();
        let (low, high) = (self.nearest(bounds.min), self.nearest(bounds.max));
        (low.y..=high.y)
            .flat_map(move |y| (low.x..=high.x).map(move |x| I64Vec2::new(x, y)))
            .filter(|&at| shape.contains(self.point(at)))
    }

    /// Whether points of a distance join the ends; `None` when the budget is spent.
    fn joins(&self, ends: &Ends, distance: f64, sure: bool, budget: &mut u64) -> Option<bool> {
        match ends {
            Ends::Points(start, goal) => {
                let goal = self.nearest(*goal);
                let from = [self.nearest(*start)].into_iter();
                self.spread(from, distance, sure, budget, |at| at == goal).map(|(_, met)| met)
            }
            Ends::WestToEast => {
                let rows = (self.area.size().y / self.h).ceil() as i64 + 1;
                let east = self.area.max.x - 0.25 * self.h;
                let from = (-1..=rows).map(|row| I64Vec2::new(0, row));
                let met = |at| self.point(at).x >= east;
                self.spread(from, distance, sure, budget, met).map(|(_, met)| met)
            }
        }
    }

    /// The points of a distance that such points join to some, over sides and corners, up to the
    /// first that `stop` says so of; and whether there was one. When `sure`, all lie inside the
    /// area; else points within a step of it count as well. `None` when the budget is spent.
    pub(super) fn spread(
        &self,
        from: impl Iterator<Item = I64Vec2>,
        distance: f64,
        sure: bool,
        budget: &mut u64,
        stop: impl Fn(I64Vec2) -> bool,
    ) -> Option<(SparseBits, bool)> {
        let inside = self.area.grown(if sure { 1e-9 } else { 1.0 } * self.h);
        let (mut seen, mut reached) = (SparseBits::default(), SparseBits::default());
        let mut open = VecDeque::new();
        let mut visit = |at: I64Vec2, open: &mut VecDeque<I64Vec2>| {
            let new = seen.insert(at);
            if new && inside.contains(self.point(at)) && self.is_clear(at, distance) {
                reached.insert(at);
                open.push_back(at);
            }
        };
        for at in from {
            *budget = budget.checked_sub(1)?;
            visit(at, &mut open);
        }
        while let Some(at) = open.pop_front() {
            if stop(at) {
                return Some((reached, true));
            }
            *budget = budget.checked_sub(1)?;
            for x in -1..=1 {
                for y in -1..=1 {
                    visit(at + I64Vec2::new(x, y), &mut open);
                }
            }
        }
        Some((reached, false))
    }
}

/// A set of lattice points, in tiles of 64 x 64.
#[derive(Default)]
pub(super) struct SparseBits(BTreeMap<(i64, i64), Box<[u64; 64]>>);

impl SparseBits {
    /// Adds a point; false when it was there.
    fn insert(&mut self, at: I64Vec2) -> bool {
        let tile = (at.x.div_euclid(64), at.y.div_euclid(64));
        let rows = self.0.entry(tile).or_insert_with(|| Box::new([0; 64]));
        let (row, bit) = (at.y.rem_euclid(64) as usize, 1 << at.x.rem_euclid(64));
        let new = rows[row] & bit == 0;
        rows[row] |= bit;
        new
    }

    /// Whether a point is in the set.
    pub(super) fn contains(&self, at: I64Vec2) -> bool {
        let tile = (at.x.div_euclid(64), at.y.div_euclid(64));
        let (row, bit) = (at.y.rem_euclid(64) as usize, 1 << at.x.rem_euclid(64));
        self.0.get(&tile).is_some_and(|rows| rows[row] & bit != 0)
    }
}
