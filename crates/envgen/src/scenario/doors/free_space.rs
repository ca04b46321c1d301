//! The free space around a doorway, and whether open leaves leave it connected.

use glam::DVec2;

use super::leaf::Leaf;
use crate::flood::flood;
use crate::geometry::{Rect, Shape};
use crate::grid::GridFrame;

/// The greatest side of a cell in metres, unless the surroundings are large.
const CELL: f64 = 0.05;

/// The greatest number of cells along each axis.
const MAX_ACROSS: f64 = 512.0;

/// The positions around a doorway at which a disc is free, as a grid of cells.
pub(super) struct FreeSpace {
    frame: GridFrame,
    radius: f64,
    free: Vec<bool>,
}

impl FreeSpace {
    /// Creates the positions of a disc within `reach` of a point along each axis, in metres. Returns `None` if cells
    /// would be so large that a leaf does not separate them.
    pub(super) fn new<'a>(
        (middle, reach): (DVec2, f64),
        solids: impl Iterator<Item = &'a (Rect, Shape)>,
        leaves: impl Iterator<Item = Leaf>,
        radius: f64,
    ) -> Option<Self> {
        let side = CELL.min(0.5 * radius).max(2.0 * reach / MAX_ACROSS);
        if side > radius {
            return None;
        }
        let across = (2.0 * reach / side).ceil() as usize;
        let frame =
            GridFrame { origin: middle - reach, cell_size: side, cols: across, rows: across };
        let area = frame.bounds().grown(radius);
        let solids: Vec<&(Rect, Shape)> =
            solids.filter(|(bounds, _)| bounds.overlaps(area)).collect();
        let leaves: Vec<Leaf> = leaves.collect();
        let is_free = |p: DVec2| {
            let meets_solid = |(bounds, shape): &&(Rect, Shape)| {
                bounds.grown(radius).contains(p) && shape.distance(p) < radius
            };
            !solids.iter().any(meets_solid) && clears(&leaves, p, radius)
        };
        let free = (0..frame.len()).map(|cell| is_free(frame.center_of(cell))).collect();
        Some(FreeSpace { frame, radius, free })
    }

    /// Whether the disc still comes from everywhere to everywhere around the doorway as before, but for where the
    /// leaves are. Every part of the space then has its connections to others as well, also beyond the surroundings.
    pub(super) fn stays_connected(&self, leaves: &[Leaf]) -> bool {
        let (cols, mut before) = (self.frame.cols, self.free.clone());
        let mut after: Vec<bool> = (0..self.free.len())
            .map(|cell| self.free[cell] && clears(leaves, self.frame.center_of(cell), self.radius))
            .collect();
        for first in 0..before.len() {
            if !before[first] {
                continue;
            }
            let mut left = Vec::new();
            flood(cols, &mut before, first, |run| {
                left.extend(run.filter(|&cell| after[cell]));
            });
            let Some(&first) = left.first() else { return false };
            let mut reached = 0;
            flood(cols, &mut after, first, |run| reached += run.len());
            if reached < left.len() {
                return false;
            }
        }
        true
    }
}

/// Whether a disc at a point touches none of some leaves.
pub(super) fn clears(leaves: &[Leaf], p: DVec2, radius: f64) -> bool {
    leaves.iter().all(|leaf| leaf.nearest_point(p).distance(p) >= radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(min: (f64, f64), max: (f64, f64)) -> (Rect, Shape) {
        let rect = Rect::new(DVec2::from(min), DVec2::from(max));
        (rect, Shape::from_rect(rect))
    }

    #[test]
    fn a_leaf_may_stand_in_a_wide_corridor_and_not_in_a_narrow_one() {
        let leaf = Leaf { hinge: DVec2::new(0.0, 0.0), tip: DVec2::new(0.0, 1.0) };
        for (width, is_wide) in [(1.5, false), (1.65, false), (1.75, true), (3.0, true)] {
            let walls = [wall((-9.0, -0.1), (9.0, 0.0)), wall((-9.0, width), (9.0, width + 0.1))];
            let space = |leaves: Vec<Leaf>, radius| {
                FreeSpace::new((DVec2::ZERO, 4.0), walls.iter(), leaves.into_iter(), radius)
                    .expect("small cells")
            };
            assert!(space(Vec::new(), 0.36).stays_connected(&[]));
            assert_eq!(space(Vec::new(), 0.36).stays_connected(&[leaf]), is_wide, "{width} m");
            // A smaller disc passes everywhere, and one that never fitted loses nothing.
            assert!(space(Vec::new(), 0.2).stays_connected(&[leaf]));
            assert!(space(Vec::new(), 1.6).stays_connected(&[leaf]));
            // Where another leaf closes the corridor already, this one closes nothing more.
            let other = Leaf { hinge: DVec2::ZERO, tip: DVec2::new(0.0, width) };
            assert!(space(vec![other], 0.36).stays_connected(&[leaf]));
        }
    }

    #[test]
    fn surroundings_that_are_too_large_for_their_cells_are_none() {
        let is_some = |reach, radius| {
            FreeSpace::new((DVec2::ZERO, reach), [].iter(), std::iter::empty(), radius).is_some()
        };
        assert!(is_some(90.0, 0.36) && !is_some(93.0, 0.36));
        assert!(is_some(2.0, 0.01) && !is_some(3.0, 0.01) && !is_some(1e8, 0.36));
    }

    #[test]
    fn no_part_of_the_space_may_vanish() {
        // A niche that a leaf in front of it fills.
        let walls = [
            wall((-2.0, 1.0), (2.0, 1.1)),
            wall((-2.0, -0.1), (2.0, 0.0)),
            wall((-0.6, 0.0), (-0.5, 1.0)),
            wall((0.5, 0.0), (0.6, 1.0)),
        ];
        let space = FreeSpace::new((DVec2::ZERO, 2.0), walls.iter(), std::iter::empty(), 0.3);
        let space = space.expect("small cells");
        let leaf = Leaf { hinge: DVec2::new(0.0, 0.0), tip: DVec2::new(0.0, 1.0) };
        assert!(!space.stays_connected(&[leaf]));
    }
}
