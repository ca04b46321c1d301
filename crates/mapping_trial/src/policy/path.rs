//! Paths to drive: straightened from those of the planner, and followed from point to point.

use glam::DVec2;

use super::costmap::{CellCost, Costmap};
use crate::map::RESOLUTION;

/// Greatest length in metres of a straight piece of a path, which bounds the work of straightening.
const LONGEST: f64 = 4.0;

/// The path that a robot follows.
#[derive(Clone, Debug, Default)]
pub(super) struct Path {
    points: Vec<DVec2>,
    /// The piece that the robot is on, counted by its first point, and the distance along it in metres.
    piece: usize,
    along: f64,
}

impl Path {
    /// Sets a path from cell to cell, and straightens it where that does not lead nearer to walls.
    pub(super) fn set(&mut self, costmap: &mut Costmap, cells: &[DVec2]) {
        self.clear();
        let Some(&first) = cells.first() else { return };
        self.points.push(first);
        let (mut from, mut to) = (0, 1);
        let mut worst = CellCost::Open;
        while to < cells.len() {
            worst = worst.max(costmap.cell_cost_at(cells[to]));
            let straight = to == from + 1
                || (cells[from].distance_squared(cells[to]) < LONGEST * LONGEST
                    && worst_between(costmap, cells[from], cells[to]) <= worst);
            if straight {
                to += 1;
            } else {
                from = to - 1;
                self.points.push(cells[from]);
                worst = costmap.cell_cost_at(cells[from]);
            }
        }
        if cells.len() > 1 {
            self.points.push(cells[cells.len() - 1]);
        }
    }

    /// Forgets the path.
    pub(super) fn clear(&mut self) {
        self.points.clear();
        (self.piece, self.along) = (0, 0.0);
    }

    /// The points of the path, the start first.
    pub(super) fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The last point.
    pub(super) fn end(&self) -> Option<DVec2> {
        self.points.last().copied()
    }

    /// Moves on to the point of the path that is nearest to the robot, within the next 1.5 m. It never
    /// moves back, nor across a wall to a later piece.
    pub(super) fn advance(&mut self, p: DVec2) {
        let (mut best, mut nearest) = ((self.piece, self.along), f64::INFINITY);
        let mut left = 1.5;
        let (mut piece, mut along) = (self.piece, self.along);
        while piece + 1 < self.points.len() && left > 0.0 {
            let (a, b) = (self.points[piece], self.points[piece + 1]);
            let length = a.distance(b);
            let ahead = (b - a) / length.max(1e-9);
            let most = length.min(along + left);
            let at = ahead.dot(p - a).clamp(along.min(most), most);
            let far = p.distance_squared(a + ahead * at);
            if far < nearest {
                (best, nearest) = ((piece, at), far);
            }
            left -= length - along;
            (piece, along) = (piece + 1, 0.0);
        }
        (self.piece, self.along) = best;
    }

    /// Calls `visit` with points of the path from the robot's position on, `step` metres apart and at
    /// most `far` metres ahead, until it returns false. If the path ends within this distance, its end
    /// is one of the points.
    pub(super) fn ahead(&self, step: f64, far: f64, mut visit: impl FnMut(DVec2) -> bool) {
        let (mut piece, mut along, mut left) = (self.piece, self.along, far);
        while piece + 1 < self.points.len() {
            let (a, b) = (self.points[piece], self.points[piece + 1]);
            let length = a.distance(b);
            while along < length {
                if left < 0.0 || !visit(a + (b - a) * (along / length)) {
                    return;
                }
                along += step;
                left -= step;
            }
            along -= length;
            piece += 1;
        }
        if left >= 0.0
            && let Some(end) = self.end()
        {
            visit(end);
        }
    }

    /// Distance in metres to the end of the path.
    pub(super) fn left(&self) -> f64 {
        let pieces = self.points.windows(2).skip(self.piece);
        (pieces.map(|ab| ab[0].distance(ab[1])).sum::<f64>() - self.along).max(0.0)
    }

    /// Whether the map still lets the robot pass, if only barely, up to so many metres ahead. Cells at
    /// the beginning that it does not fit into, and has to leave, do not count.
    pub(super) fn is_passable(&self, costmap: &mut Costmap, far: f64) -> bool {
        let (mut out, mut passable) = (false, true);
        self.ahead(0.1, far, |p| {
            let cell_cost = costmap.cell_cost_at(p);
            out |= cell_cost.is_passable();
            passable = cell_cost <= CellCost::Squeeze || (!out && cell_cost != CellCost::Occupied);
            passable
        });
        passable
    }
}

/// The worst cell cost on the straight line between two points.
pub(super) fn worst_between(costmap: &mut Costmap, from: DVec2, to: DVec2) -> CellCost {
    let offset = to - from;
    let steps = (offset.length() / RESOLUTION).ceil().clamp(1.0, 1e4);
    let mut worst = CellCost::Open;
    for step in 0..=steps as usize {
        worst = worst.max(costmap.cell_cost_at(from + offset * (step as f64 / steps)));
        if worst == CellCost::Occupied {
            break;
        }
    }
    worst
}
