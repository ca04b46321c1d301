//! An index of the pieces of a world's solid parts, and queries for those near each other.

use std::borrow::Borrow;

use glam::DVec2;

use super::budget::{Budget, Doubt, MAX_PIECES};
use super::piece::{Gap, Piece};
use crate::geometry::{Rect, Shape};
use crate::grid::{Convex, GridFrame, GridIndex, index_area};

/// The most cells in which a piece is listed, on average over all pieces.
const MAX_LISTINGS: usize = 8;

/// Cost of the fast test of two pieces that are not both round, and cost of the full comparison of two that it does
/// not separate.
const LOOK_COST: u64 = 3;
const GAP_COST: u64 = 32;

/// Pieces, with a grid whose cells list those within reach.
pub(super) struct Pieces {
    list: Vec<Piece>,
    /// The requested reach, and the reach of the cells.
    wanted: f64,
    reach: f64,
    index: GridIndex,
}

impl Pieces {
    /// Indexes the pieces of shapes for queries within `reach` of them.
    pub(super) fn new(
        shapes: impl Iterator<Item = impl Borrow<Shape>>,
        reach: f64,
    ) -> Result<Self, Doubt> {
        let mut list = Vec::new();
        for shape in shapes {
            if list.len() + Piece::count(shape.borrow()) > MAX_PIECES {
                return Err(Doubt::Pieces);
            }
            Piece::of(shape.borrow(), |piece| list.push(piece));
        }
        let around = list.iter().map(Piece::bounds).reduce(Rect::union);
        let around = around.unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
        // A greater reach would not find more: every piece is within this distance of any other.
        let (wanted, reach) = (reach, reach.min(1.0 + around.size().length()));
        let (area, len) = (index_area(Some(around), reach), list.len());
        let index = GridIndex::new(area, len as f64, len, Some(MAX_LISTINGS), |i, frame, visit| {
            touched_runs(&list[i], reach, frame, visit);
        });
        Ok(Pieces { list, wanted, reach, index })
    }

    pub(super) fn list(&self) -> &[Piece] {
        &self.list
    }

    /// Returns the distance from a point to the nearest piece; infinite beyond the reach.
    pub(super) fn clearance(&self, p: DVec2, budget: &mut Budget) -> Result<f64, Doubt> {
        let near = self.index.at(p);
        budget.spend(near.len() as u64)?;
        let distances = near.iter().map(|&i| self.list[i as usize].distance(p));
        let mut least = distances.fold(f64::INFINITY, f64::min);
        if least > self.reach && self.wanted > self.reach {
            budget.spend(self.list.len() as u64)?;
            least = self.list.iter().map(|piece| piece.distance(p)).fold(least, f64::min);
        }
        Ok(if least <= self.wanted { least } else { f64::INFINITY })
    }

    /// Returns the pieces within reach of a rectangle, and some more.
    pub(super) fn near(&self, around: Rect, budget: &mut Budget) -> Result<Vec<Piece>, Doubt> {
        if self.wanted > self.reach {
            budget.spend(self.list.len() as u64)?;
            return Ok(self.list.clone());
        }
        let mut numbers = Vec::new();
        let frame = self.index.frame;
        frame.touched_runs(
            &Convex::Polygon(&Shape::from_rect(around).corners()),
            |row, from, to| {
                for cell in frame.index(from, row)..=frame.index(to, row) {
                    numbers.extend_from_slice(self.index.of(cell));
                }
            },
        );
        numbers.sort_unstable();
        numbers.dedup();
        budget.spend(numbers.len() as u64)?;
        Ok(numbers.into_iter().map(|i| self.list[i as usize]).collect())
    }

    /// Calls `visit` for every pair of pieces at most `distance` apart, which must be at most twice the reach,
    /// until `visit` returns true.
    pub(super) fn pairs(
        &self,
        distance: f64,
        budget: &mut Budget,
        mut visit: impl FnMut(usize, usize, Gap, &mut Budget) -> Result<bool, Doubt>,
    ) -> Result<(), Doubt> {
        let mut seen = vec![u32::MAX; self.list.len()];
        for (i, piece) in self.list.iter().enumerate() {
            let mut done = Ok(false);
            let frame = self.index.frame;
            touched_runs(piece, self.reach, &frame, &mut |row, from, to| {
                for cell in frame.index(from, row)..=frame.index(to, row) {
                    if done == Ok(false) {
                        done = self.pairs_in(cell, i, distance, &mut seen, budget, &mut visit);
                    }
                }
            });
            if done? {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Visits the pairs of a piece with those before it that a cell lists and that were not visited yet; returns
    /// whether this is enough.
    fn pairs_in(
        &self,
        cell: usize,
        i: usize,
        distance: f64,
        seen: &mut [u32],
        budget: &mut Budget,
        visit: &mut impl FnMut(usize, usize, Gap, &mut Budget) -> Result<bool, Doubt>,
    ) -> Result<bool, Doubt> {
        // The lists are in order.
        for &j in self.index.of(cell).iter().take_while(|&&j| (j as usize) < i) {
            budget.spend(1)?;
            let j = j as usize;
            if std::mem::replace(&mut seen[j], i as u32) == i as u32 {
                continue;
            }
            let (a, b) = (&self.list[i], &self.list[j]);
            if !(a.is_round() && b.is_round()) {
                budget.spend(LOOK_COST)?;
                if a.is_parted(b, distance) {
                    continue;
                }
                budget.spend(GAP_COST)?;
            }
            if let Some(gap) = a.gap(b, distance)
                && visit(i, j, gap, budget)?
            {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Visits the cells that lie within `reach` of a piece, and perhaps a few more.
fn touched_runs(
    piece: &Piece,
    reach: f64,
    frame: &GridFrame,
    visit: &mut dyn FnMut(usize, usize, usize),
) {
    // Rounding must not keep a piece out of a cell that it just reaches.
    let reach = piece.radius + reach + 1e-8 * (1.0 + frame.cell_size);
    if piece.is_round() {
        frame.touched_runs(&Convex::Disc(piece.center, reach), visit);
    } else {
        frame.touched_runs(&Convex::Polygon(&piece.corners(reach)), visit);
    }
}
