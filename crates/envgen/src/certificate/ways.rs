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
const MOST_POINTS: u64 = 1 << 27;

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
        let flood = Flood::new(world, area, size.x / (size.x / h).ceil(), radius);
        let slack = flood.h * FRAC_1_SQRT_2;
        match flood.reaches(ends, radius + slack, true, &mut budget) {
            None => return Verdict::Undecided,
            Some(true) => return verdict(true),
            Some(false) => {}
        }
        if radius > slack {
            match flood.reaches(ends, (radius - slack) * (1.0 - 1e-9), false, &mut budget) {
                None => return Verdict::Undecided,
                Some(false) => return verdict(false),
                Some(true) => {}
            }
        }
        h *= 0.5;
    }
}

struct Flood {
    area: Rect,
    h: f64,
    /// The shapes that can be within reach of a point, by the point's cell.
    near: Lists<u32>,
    lattice: Lattice,
    shapes: Vec<Shape>,
}

impl Flood {
    fn new(world: &World, area: Rect, h: f64, radius: f64) -> Self {
        let shapes: Vec<Shape> = world.solids().map(|solid| solid.shape.into_owned()).collect();
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

    fn point(&self, at: I64Vec2) -> DVec2 {
        self.area.min + at.as_dvec2() * self.h
    }

    /// Whether a point is at least `distance` away from all solids.
    fn is_clear(&self, p: DVec2, distance: f64) -> bool {
        let near = self.lattice.cell_at(p).map_or(&[][..], |cell| self.near.of(cell));
        near.iter().all(|&i| self.shapes[i as usize].distance(p) >= distance)
    }

    /// Whether points of a distance join the ends. When `sure`, every point lies inside the area;
    /// else points within a step of it count as well. `None` when the budget is spent.
    fn reaches(&self, ends: &Ends, distance: f64, sure: bool, budget: &mut u64) -> Option<bool> {
        let margin = if sure { 1e-9 * self.h } else { self.h };
        let inside = self.area.grown(margin);
        let mut seen = SparseBits::default();
        let mut open = VecDeque::new();
        let east = self.area.max.x - 0.25 * self.h;
        let goals = match ends {
            Ends::Points(_, goal) => self.around(*goal),
            Ends::WestToEast => Vec::new(),
        };
        let mut visit = |at: I64Vec2, open: &mut VecDeque<I64Vec2>| {
            let p = self.point(at);
            if seen.insert(at) && inside.contains(p) && self.is_clear(p, distance) {
                open.push_back(at);
            }
        };
        match ends {
            Ends::Points(start, _) => {
                self.around(*start).into_iter().for_each(|at| visit(at, &mut open));
            }
            Ends::WestToEast => {
                let rows = ((self.area.size().y + 2.0 * margin) / self.h).ceil() as i64;
                // A column of points is a small part of what the budget allows.
                if rows as u64 > *budget {
                    return None;
                }
                (-1..=rows).for_each(|row| visit(I64Vec2::new(0, row), &mut open));
            }
        }
        while let Some(at) = open.pop_front() {
            let there = match ends {
                Ends::Points(..) => goals.contains(&at),
                Ends::WestToEast => self.point(at).x >= east,
            };
            if there {
                return Some(true);
            }
            *budget = budget.checked_sub(1)?;
            for x in -1..=1 {
                for y in -1..=1 {
                    visit(at + I64Vec2::new(x, y), &mut open);
                }
            }
        }
        Some(false)
    }

    /// The lattice point nearest to a place: a step of h / sqrt 2 at most away.
    fn around(&self, p: DVec2) -> Vec<I64Vec2> {
        vec![((p - self.area.min) / self.h).round().as_i64vec2()]
    }
}

/// A set of lattice points, in tiles of 64 x 64.
#[derive(Default)]
struct SparseBits(BTreeMap<(i64, i64), Box<[u64; 64]>>);

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
}
