//! Paths on which a disc has room to spare: a proof that it passes where pieces near each other are too
//! many to compare in pairs.

use std::borrow::Cow;

use glam::DVec2;

use super::budget::{Budget, Doubt};
use super::piece_index::Pieces;
use super::squares::{Square, Squares};
use crate::geometry::{Rect, Shape};

/// The clearance to spare along the whole path, as a share of the radius. The claims of generators
/// leave a fifth of half the width of hallways and roads.
const SPARE: f64 = 0.2;

/// The least step along a line, as a share of the radius: a disc with less to spare does not pass.
const STEP: f64 = 1e-3;

/// Free space with room to spare.
pub(super) struct Roomy {
    pieces: Pieces,
    squares: Squares,
    radius: f64,
    reach: f64,
}

impl Roomy {
    /// The free space of a disc with its middle inside of `area`. `radius` must be above 0.
    pub(super) fn new<'a>(
        shapes: impl Iterator<Item = Cow<'a, Shape>>,
        area: Rect,
        radius: f64,
        budget: &mut Budget,
    ) -> Result<Self, Doubt> {
        let spare = SPARE * radius;
        let reach = radius + spare;
        let pieces = Pieces::new(shapes, reach)?;
        let squares = Squares::new(pieces.list(), area, radius, spare, budget)?;
        Ok(Roomy { pieces, squares, radius, reach })
    }

    /// Whether such a path is found between two points that lie in the area and outside of all shapes.
    pub(super) fn joins(&self, ends: [DVec2; 2], budget: &mut Budget) -> Result<bool, Doubt> {
        let [from, to] = ends;
        let (Some(from), Some(to)) = (self.region(from, budget)?, self.region(to, budget)?) else {
            return Ok(false);
        };
        Ok(from == to)
    }

    /// The region that a point lies in, or reaches on a straight line.
    fn region(&self, p: DVec2, budget: &mut Budget) -> Result<Option<usize>, Doubt> {
        if let Some(square) = self.squares.at(p) {
            return Ok(Some(self.squares.region(square)));
        }
        let mut near: Vec<Square> = Vec::new();
        self.squares.over(&Shape::Disc { center: p, radius: self.radius }, |square| {
            near.push(square);
            budget.spend(1)
        })?;
        near.sort_by(|a, b| a.middle.distance_squared(p).total_cmp(&b.middle.distance_squared(p)));
        for square in near {
            if self.is_free(p, square.middle, budget)? {
                return Ok(Some(self.squares.region(square)));
            }
        }
        Ok(None)
    }

    /// Whether pieces leave room for the disc along a line. An area is convex, so that a line between
    /// two of its points is inside.
    fn is_free(&self, from: DVec2, to: DVec2, budget: &mut Budget) -> Result<bool, Doubt> {
        let length = from.distance(to);
        let mut done = 0.0;
        while done < length {
            let p = from.lerp(to, done / length);
            let spare = self.pieces.clearance(p, budget)?.min(self.reach) - self.radius;
            if spare < STEP * self.radius {
                return Ok(false);
            }
            done += spare;
        }
        Ok(true)
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
        let roomy = Roomy::new(shapes.iter().map(Cow::Borrowed), area, radius, budget).unwrap();
        roomy.joins(ends, budget).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
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
            let larger = (1.0 + 1.01 * SPARE) * radius;
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
    fn ends_at_the_border_get_to_free_squares() {
        // A corridor of 1 m that begins and ends at the area's sides.
        let wall = |y: f64| Shape::Segment { a: DVec2::new(-1.0, y), b: DVec2::new(9.0, y) };
        let walls = [wall(0.0), wall(1.0)];
        let area = Rect::new(DVec2::new(0.0, -1.0), DVec2::new(8.0, 2.0));
        let ends = [DVec2::new(0.0, 0.5), DVec2::new(8.0, 0.5)];
        assert!(joins(&walls, area, 0.4, ends));
        assert!(!joins(&walls, area, 0.45, ends));
        assert!(!joins(&walls, area, 0.4, [ends[0], DVec2::new(4.0, 1.5)]));
        let bollard = Shape::Disc { center: DVec2::new(4.0, 0.5), radius: 0.1 };
        assert!(!joins(&[walls[0].clone(), walls[1].clone(), bollard], area, 0.4, ends));
    }
}
