//! The polygons among the solid parts of a world. The pieces of a polygon are only its sides.

use std::borrow::Cow;

use glam::DVec2;

use super::budget::{Budget, Doubt};
use super::piece::Piece;
use crate::geometry::{Rect, Shape};
use crate::grid::{Convex, GridIndex, index_area};

/// The most cells in which a polygon is listed, on average.
const MAX_LISTINGS: usize = 24;

/// Polygons, with a grid whose cells list the polygons with which they may have a point in common.
pub(super) struct Outlines<'a> {
    list: Vec<Cow<'a, Shape>>,
    index: GridIndex,
}

impl<'a> Outlines<'a> {
    /// Indexes the polygons among some shapes.
    pub(super) fn new(shapes: impl Iterator<Item = Cow<'a, Shape>>) -> Self {
        let list: Vec<_> =
            shapes.filter(|shape| matches!(**shape, Shape::Polygon { .. })).collect();
        let around = list.iter().map(|outline| outline.bounds()).reduce(Rect::union);
        let (area, len) = (index_area(around, 0.0), list.len());
        let index = GridIndex::new(area, len as f64, len, Some(MAX_LISTINGS), |i, frame, visit| {
            // Rounding must not keep a polygon out of a cell that it just reaches.
            let bounds = list[i].bounds().grown(1e-8 * (1.0 + frame.cell_size));
            frame.touched_runs(&Convex::Polygon(&Shape::from_rect(bounds).corners()), visit);
        });
        Outlines { list, index }
    }

    /// Whether a point lies in one of the polygons.
    pub(super) fn contain(&self, p: DVec2, budget: &mut Budget) -> Result<bool, Doubt> {
        let near = self.index.at(p);
        let cost = |&i: &u32| Piece::count(&self.list[i as usize]) as u64;
        budget.spend(near.iter().map(cost).sum())?;
        Ok(near.iter().any(|&i| self.list[i as usize].contains(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn points_are_in_the_polygons_that_contain_them() {
        let mut draws = Seed(4).stream("test", 0);
        let mut point = |size: f64| DVec2::new(draws.unit(), draws.unit()) * size;
        let shapes: Vec<Shape> = (0..300)
            .map(|i| {
                let corner = point(100.0);
                match i % 3 {
                    0 => Shape::Disc { center: corner, radius: 2.0 },
                    _ => Shape::Polygon {
                        vertices: [0.0, 1.0, 2.0].map(|_| corner + point(9.0)).into(),
                    },
                }
            })
            .collect();
        let outlines = Outlines::new(shapes.iter().map(Cow::Borrowed));
        let polygons = || shapes.iter().filter(|shape| matches!(shape, Shape::Polygon { .. }));
        let corners: Vec<DVec2> = polygons().flat_map(Shape::corners).collect();
        for p in
            (0..3000).map(|_| point(120.0) - 5.0).collect::<Vec<_>>().into_iter().chain(corners)
        {
            let slow = polygons().any(|outline| outline.contains(p));
            assert_eq!(outlines.contain(p, &mut Budget::new(1000)), Ok(slow), "{p}");
        }
        let none = Outlines::new(std::iter::empty());
        assert_eq!(none.contain(DVec2::ZERO, &mut Budget::new(0)), Ok(false));
    }
}
