//! Shapes of parts.

use std::f64::consts::PI;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{
    Rect, distance_between_segments, distance_to_segment, edges, nearest_on_segment,
    polygon_contains, signed_area, unit_vector, wrap_angle,
};

/// A shape in world coordinates, used by colliders, rays, rasters and pictures.
///
/// ```
/// use envgen::geometry::Shape;
/// use envgen::glam::DVec2;
///
/// // A wall 2 m long and 0.2 m thick.
/// let wall = Shape::thick_segment(DVec2::ZERO, DVec2::new(2.0, 0.0), 0.2, 0.0);
/// assert!((wall.area() - 0.4).abs() < 1e-12);
/// assert!(wall.contains(DVec2::new(1.0, 0.05)));
/// assert!((wall.distance(DVec2::new(1.0, 1.1)) - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A line segment without thickness.
    Segment {
        /// One end.
        a: DVec2,
        /// The other end.
        b: DVec2,
    },
    /// A filled circle.
    Disc {
        /// The centre.
        center: DVec2,
        /// Radius in metres.
        radius: f64,
    },
    /// A filled rectangle, rotated about its centre.
    Box {
        /// The centre.
        center: DVec2,
        /// Half the width (along the heading) and half the height (across it).
        half_size: DVec2,
        /// The direction of the width, in radians.
        heading: f64,
    },
    /// A filled simple polygon, counter-clockwise. The first corner is not repeated at the end.
    Polygon {
        /// The corners, at least three.
        vertices: Vec<DVec2>,
    },
}

impl Shape {
    /// Returns a box that fills an axis-aligned rectangle.
    pub fn from_rect(rect: Rect) -> Shape {
        Shape::Box { center: rect.center(), half_size: rect.size() * 0.5, heading: 0.0 }
    }

    /// Returns a box of the given thickness around the segment from `a` to `b`, extended at both ends by
    /// `extension` metres.
    ///
    /// ```
    /// use envgen::geometry::Shape;
    /// use envgen::glam::DVec2;
    ///
    /// // Two walls meet in a corner without a notch where each is longer by half its thickness.
    /// let (corner, end) = (DVec2::ZERO, DVec2::new(3.0, 0.0));
    /// let wall = Shape::thick_segment(corner, end, 0.2, 0.1);
    /// assert!(wall.contains(DVec2::new(-0.05, 0.05)));
    /// assert!((wall.bounds().size() - DVec2::new(3.2, 0.2)).length() < 1e-12);
    /// ```
    pub fn thick_segment(a: DVec2, b: DVec2, thickness: f64, extension: f64) -> Shape {
        let along = b - a;
        Shape::Box {
            center: (a + b) * 0.5,
            half_size: DVec2::new(along.length() * 0.5 + extension, thickness * 0.5),
            heading: libm::atan2(along.y, along.x),
        }
    }

    /// Returns the corners of a box or polygon, counter-clockwise, or the ends of a segment. A disc has no corners.
    pub fn corners(&self) -> Vec<DVec2> {
        match self {
            Shape::Segment { a, b } => vec![*a, *b],
            Shape::Disc { .. } => Vec::new(),
            Shape::Box { center, half_size, heading } => {
                box_corners(*center, *half_size, *heading).to_vec()
            }
            Shape::Polygon { vertices } => vertices.clone(),
        }
    }

    /// Returns the smallest axis-aligned rectangle around the shape.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::geometry::Shape;
    /// use envgen::glam::DVec2;
    ///
    /// // A box of 4 m by 2 m whose width lies along +y.
    /// let half_size = DVec2::new(2.0, 1.0);
    /// let shape = Shape::Box { center: DVec2::new(5.0, 5.0), half_size, heading: FRAC_PI_2 };
    /// assert_eq!(shape.bounds().min, DVec2::new(4.0, 3.0));
    /// assert_eq!(shape.bounds().size(), DVec2::new(2.0, 4.0));
    /// ```
    pub fn bounds(&self) -> Rect {
        match self {
            Shape::Disc { center, radius } => Rect::new(*center, *center).grown(*radius),
            Shape::Segment { a, b } => Rect::new(a.min(*b), a.max(*b)),
            Shape::Box { center, half_size, heading } => {
                let u = box_axis(*heading).abs();
                let half = DVec2::new(
                    u.x * half_size.x + u.y * half_size.y,
                    u.y * half_size.x + u.x * half_size.y,
                );
                Rect::new(*center - half, *center + half)
            }
            Shape::Polygon { vertices } => Rect::around(vertices.iter().copied())
                .unwrap_or(Rect::new(DVec2::ZERO, DVec2::ZERO)),
        }
    }

    /// Returns whether a point lies inside the shape. A segment has no interior and contains no point.
    ///
    /// The border of a disc or box is part of it, up to rounding. Of the border of a polygon, the sides that have the
    /// interior to their right, and level ones that have it above them, are part of it, and the others are not: where
    /// polygons share a side, a point on it lies in just one of them. Where all of the border must count, ask whether
    /// the [`distance`](Shape::distance) is 0, up to rounding.
    ///
    /// ```
    /// use envgen::geometry::{Rect, Shape};
    /// use envgen::glam::DVec2;
    ///
    /// let square = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::ONE));
    /// let polygon = Shape::Polygon { vertices: square.corners() };
    /// let (left, right) = (DVec2::new(0.0, 0.5), DVec2::new(1.0, 0.5));
    /// assert!(square.contains(left) && square.contains(right));
    /// assert!(polygon.contains(left) && !polygon.contains(right));
    /// assert_eq!((polygon.distance(left), polygon.distance(right)), (0.0, 0.0));
    /// ```
    pub fn contains(&self, p: DVec2) -> bool {
        match self {
            Shape::Segment { .. } => false,
            Shape::Disc { center, radius } => p.distance_squared(*center) <= radius * radius,
            Shape::Box { center, half_size, heading } => {
                let local = into_box(p - *center, *heading);
                local.abs().cmple(*half_size).all()
            }
            Shape::Polygon { vertices } => polygon_contains(vertices, p),
        }
    }

    /// Returns the distance from a point to the shape in metres, which is 0 inside it.
    pub fn distance(&self, p: DVec2) -> f64 {
        match self {
            Shape::Segment { a, b } => distance_to_segment(p, *a, *b),
            Shape::Disc { center, radius } => (p.distance(*center) - radius).max(0.0),
            Shape::Box { center, half_size, heading } => {
                let local = into_box(p - *center, *heading);
                (local.abs() - *half_size).max(DVec2::ZERO).length()
            }
            Shape::Polygon { vertices } if polygon_contains(vertices, p) => 0.0,
            Shape::Polygon { vertices } => edges(vertices)
                .map(|(a, b)| distance_to_segment(p, a, b))
                .fold(f64::INFINITY, f64::min),
        }
    }

    /// Returns the distance from the segment from `a` to `b` to the shape in metres, which is 0 where they meet.
    pub(crate) fn distance_from_segment(&self, a: DVec2, b: DVec2) -> f64 {
        let from_sides = |vertices: &[DVec2]| {
            edges(vertices)
                .map(|(c, d)| distance_between_segments(a, b, c, d))
                .fold(f64::INFINITY, f64::min)
        };
        match self {
            Shape::Segment { a: c, b: d } => distance_between_segments(a, b, *c, *d),
            Shape::Disc { center, radius } => {
                (distance_to_segment(*center, a, b) - radius).max(0.0)
            }
            shape if shape.contains(a) => 0.0,
            Shape::Box { center, half_size, heading } => {
                from_sides(&box_corners(*center, *half_size, *heading))
            }
            Shape::Polygon { vertices } => from_sides(vertices),
        }
    }

    /// Returns the point of the shape that is nearest to a point, which is the point itself if it lies inside.
    ///
    /// ```
    /// use envgen::geometry::Shape;
    /// use envgen::glam::DVec2;
    ///
    /// let trunk = Shape::Disc { center: DVec2::new(3.0, 0.0), radius: 0.5 };
    /// assert_eq!(trunk.nearest_point(DVec2::ZERO), DVec2::new(2.5, 0.0));
    /// let inside = DVec2::new(3.2, 0.1);
    /// assert_eq!(trunk.nearest_point(inside), inside);
    /// ```
    pub fn nearest_point(&self, p: DVec2) -> DVec2 {
        match self {
            Shape::Segment { a, b } => nearest_on_segment(p, *a, *b),
            Shape::Disc { center, radius } => *center + (p - *center).clamp_length_max(*radius),
            Shape::Box { center, half_size, heading } => {
                let axis = box_axis(*heading);
                *center
                    + axis.rotate(into_box(p - *center, *heading).clamp(-*half_size, *half_size))
            }
            Shape::Polygon { vertices } if polygon_contains(vertices, p) => p,
            Shape::Polygon { vertices } => edges(vertices)
                .map(|(a, b)| nearest_on_segment(p, a, b))
                .min_by(|q, r| p.distance_squared(*q).total_cmp(&p.distance_squared(*r)))
                .unwrap_or(p),
        }
    }

    /// Returns the shape translated by `by` metres.
    pub fn moved(&self, by: DVec2) -> Shape {
        match self {
            Shape::Segment { a, b } => Shape::Segment { a: *a + by, b: *b + by },
            Shape::Disc { center, radius } => Shape::Disc { center: *center + by, radius: *radius },
            Shape::Box { center, half_size, heading } => {
                Shape::Box { center: *center + by, half_size: *half_size, heading: *heading }
            }
            Shape::Polygon { vertices } => {
                Shape::Polygon { vertices: vertices.iter().map(|&v| v + by).collect() }
            }
        }
    }

    /// Returns the shape rotated about the middle of its bounds by an angle in radians, counter-clockwise. Quarter
    /// turns keep an axis-aligned box axis-aligned.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::geometry::{Rect, Shape};
    /// use envgen::glam::DVec2;
    ///
    /// let desk = Shape::from_rect(Rect::new(DVec2::ZERO, DVec2::new(2.0, 1.0)));
    /// let turned = desk.turned(FRAC_PI_2);
    /// // The middle stays where it was.
    /// assert_eq!(turned.bounds().center(), desk.bounds().center());
    /// assert_eq!(turned.bounds().size(), DVec2::new(1.0, 2.0));
    /// ```
    pub fn turned(&self, angle: f64) -> Shape {
        let (middle, axis) = (self.bounds().center(), box_axis(wrap_angle(angle)));
        let turn = |p: DVec2| middle + axis.rotate(p - middle);
        match self {
            Shape::Segment { a, b } => Shape::Segment { a: turn(*a), b: turn(*b) },
            Shape::Disc { .. } => self.clone(),
            Shape::Box { center, half_size, heading } => {
                let heading = wrap_angle(heading + angle);
                Shape::Box { center: *center, half_size: *half_size, heading }
            }
            Shape::Polygon { vertices } => {
                Shape::Polygon { vertices: vertices.iter().map(|&v| turn(v)).collect() }
            }
        }
    }

    /// Returns both ends of the line through the middle of the shape along its longer side, and the width across it
    /// in metres. For a polygon, the line has the direction of its longest side.
    pub(crate) fn long_axis(&self) -> (DVec2, DVec2, f64) {
        let around = |center: DVec2, axis: DVec2, half: DVec2| {
            let is_along = half.x >= half.y;
            let reach = if is_along { axis * half.x } else { axis.perp() * half.y };
            (center - reach, center + reach, 2.0 * half.min_element())
        };
        match self {
            Shape::Box { center, half_size, heading } => {
                around(*center, box_axis(*heading), *half_size)
            }
            Shape::Segment { a, b } => (*a, *b, 0.0),
            Shape::Disc { center, radius } => around(*center, DVec2::X, DVec2::splat(*radius)),
            Shape::Polygon { vertices } => {
                let sides = edges(vertices).map(|(a, b)| b - a);
                let longest =
                    sides.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
                let axis = longest.and_then(DVec2::try_normalize).unwrap_or(DVec2::X);
                let axis = if (axis.x, axis.y) < (0.0, 0.0) { -axis } else { axis };
                let back = DVec2::new(axis.x, -axis.y);
                let turned = vertices.iter().map(|&v| back.rotate(v));
                let Some(bounds) = Rect::around(turned) else {
                    return (DVec2::ZERO, DVec2::ZERO, 0.0);
                };
                around(axis.rotate(bounds.center()), axis, 0.5 * bounds.size())
            }
        }
    }

    /// Returns the area in square metres, which is 0 for a segment.
    pub fn area(&self) -> f64 {
        match self {
            Shape::Segment { .. } => 0.0,
            Shape::Disc { radius, .. } => PI * radius * radius,
            Shape::Box { half_size, .. } => 4.0 * half_size.x * half_size.y,
            Shape::Polygon { vertices } => signed_area(vertices).abs(),
        }
    }
}

/// Returns the corners of a box, counter-clockwise.
fn box_corners(center: DVec2, half_size: DVec2, heading: f64) -> [DVec2; 4] {
    let u = box_axis(heading);
    let (u, v) = (u * half_size.x, u.perp() * half_size.y);
    [center - u - v, center + u - v, center + u + v, center - u + v]
}

/// Returns the direction of a box's width as a unit vector. Quarter turns, which most boxes have, are exact.
pub fn box_axis(heading: f64) -> DVec2 {
    if heading == 0.0 {
        DVec2::X
    } else if heading == PI / 2.0 {
        DVec2::Y
    } else if heading == PI || heading == -PI {
        DVec2::NEG_X
    } else if heading == -PI / 2.0 {
        DVec2::NEG_Y
    } else {
        unit_vector(heading)
    }
}

/// Transforms an offset from a box's centre into the box's own axes.
fn into_box(offset: DVec2, heading: f64) -> DVec2 {
    let u = box_axis(heading);
    DVec2::new(offset.dot(u), u.perp_dot(offset))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit_box(heading: f64) -> Shape {
        Shape::Box { center: DVec2::new(1.0, 2.0), half_size: DVec2::new(2.0, 0.5), heading }
    }

    #[test]
    fn a_box_is_the_polygon_of_its_corners() {
        let shape = unit_box(0.7);
        let polygon = Shape::Polygon { vertices: shape.corners() };
        assert!((shape.area() - polygon.area()).abs() < 1e-12);
        assert!(signed_area(&shape.corners()) > 0.0);
        let (a, b) = (shape.bounds(), polygon.bounds());
        assert!(a.min.distance(b.min) < 1e-12 && a.max.distance(b.max) < 1e-12);
    }

    proptest! {
        #[test]
        fn the_distance_from_a_line_is_that_of_its_nearest_point(
            ax in -5.0..5.0_f64, ay in -5.0..5.0_f64, bx in -5.0..5.0_f64, by in -5.0..5.0_f64,
            heading in -4.0..4.0_f64, which in 0..4,
        ) {
            let (a, b) = (DVec2::new(ax, ay), DVec2::new(bx, by));
            let shape = match which {
                0 => unit_box(heading),
                1 => Shape::Polygon { vertices: unit_box(heading).corners() },
                2 => Shape::Disc { center: DVec2::new(1.0, 2.0), radius: 1.5 },
                _ => Shape::Segment { a: DVec2::new(1.0, 2.0), b: DVec2::new(-2.0, 1.0) },
            };
            let found = shape.distance_from_segment(a, b);
            let points = (0..=1000).map(|i| a.lerp(b, f64::from(i) / 1000.0));
            let sampled = points.map(|p| shape.distance(p)).fold(f64::INFINITY, f64::min);
            prop_assert!(found <= sampled + 1e-9, "{found} {sampled}");
            prop_assert!(sampled <= found + 0.0005 * a.distance(b) + 1e-9, "{found} {sampled}");
        }

        #[test]
        fn moved_and_turned_shapes_keep_what_they_are(
            x in -5.0..5.0_f64, y in -5.0..5.0_f64, angle in -9.0..9.0_f64, which in 0..4,
        ) {
            let by = DVec2::new(x, y);
            let shape = match which {
                0 => unit_box(0.4),
                1 => Shape::Polygon { vertices: vec![DVec2::ZERO, DVec2::X, DVec2::new(3.0, 2.0)] },
                2 => Shape::Disc { center: DVec2::new(1.0, 2.0), radius: 1.5 },
                _ => Shape::Segment { a: DVec2::new(1.0, 2.0), b: DVec2::new(-2.0, 1.0) },
            };
            let moved = shape.moved(by);
            prop_assert!(moved.bounds().center().distance(shape.bounds().center() + by) < 1e-12);
            let turned = shape.turned(angle);
            prop_assert!((turned.area() - shape.area()).abs() < 1e-9);
            // Every point keeps its distance to the shape when it turns with it.
            let middle = shape.bounds().center();
            let p = middle + by;
            let there = middle + unit_vector(angle).rotate(by);
            prop_assert!((turned.distance(there) - shape.distance(p)).abs() < 1e-9);
        }

        #[test]
        fn distance_is_zero_exactly_inside(
            x in -5.0..5.0_f64, y in -5.0..5.0_f64, heading in -4.0..4.0_f64,
        ) {
            let p = DVec2::new(x, y);
            let shape = unit_box(heading);
            let polygon = Shape::Polygon { vertices: shape.corners() };
            prop_assert!((shape.distance(p) - polygon.distance(p)).abs() < 1e-9);
            prop_assert_eq!(shape.contains(p), shape.distance(p) == 0.0);
            prop_assert!(!shape.contains(p) || shape.bounds().grown(1e-9).contains(p));
        }
    }

    #[test]
    fn a_point_between_polygons_lies_in_one_of_them() {
        let corner = |x: u32, y: u32| DVec2::new(f64::from(x), f64::from(y));
        // Squares of one metre, each cut into two triangles.
        let mut tiles = Vec::new();
        for (x, y) in (0..4).flat_map(|x| (0..4).map(move |y| (x, y))) {
            let [a, b, c, d] =
                [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            tiles
                .extend([vec![a, b, c], vec![a, c, d]].map(|vertices| Shape::Polygon { vertices }));
        }
        for (i, j) in (1..16).flat_map(|i| (1..16).map(move |j| (i, j))) {
            let p = 0.25 * corner(i, j);
            let around: Vec<_> = tiles.iter().filter(|tile| tile.distance(p) == 0.0).collect();
            assert_eq!(around.iter().filter(|tile| tile.contains(p)).count(), 1, "{p}");
            let is_on_side = i % 4 == 0 || j % 4 == 0 || i % 4 == j % 4;
            assert_eq!(around.len() > 1, is_on_side, "{p}");
        }
    }

    #[test]
    fn a_turned_rectangle_has_the_axis_of_its_box() {
        for heading in [0.0, 0.4, 0.5 * PI, 2.5, -0.8] {
            let half_size = DVec2::new(0.6, 0.1);
            let shape = Shape::Box { center: DVec2::new(3.0, -2.0), half_size, heading };
            let (a, b, across) = shape.long_axis();
            let (c, d, width) = Shape::Polygon { vertices: shape.corners() }.long_axis();
            let is_near = |p: DVec2, q: DVec2| p.distance(q) < 1e-9;
            assert!(is_near(a, c) && is_near(b, d) || is_near(a, d) && is_near(b, c), "{heading}");
            assert!((across - 0.2).abs() < 1e-9 && (width - 0.2).abs() < 1e-9, "{heading}");
            assert!((a.distance(b) - 1.2).abs() < 1e-9, "{heading}");
        }
    }
}
