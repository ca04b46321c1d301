//! Simple polygons, given by their corners.

use glam::DVec2;

use super::unit_vector;

/// Returns the sides of a closed polygon as pairs of corners.
///
/// ```
/// use envgen::geometry::edges;
/// use envgen::glam::DVec2;
///
/// let sides: Vec<_> = edges(&[DVec2::ZERO, DVec2::X, DVec2::Y]).collect();
/// assert_eq!(sides.len(), 3);
/// // The last side leads back to the first corner.
/// assert_eq!(sides[2], (DVec2::Y, DVec2::ZERO));
/// ```
pub fn edges(vertices: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    vertices.iter().copied().zip(vertices.iter().copied().cycle().skip(1))
}

/// Returns the area of a polygon in square metres, positive when it runs counter-clockwise.
///
/// ```
/// use envgen::geometry::signed_area;
/// use envgen::glam::DVec2;
///
/// let square = [DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(2.0, 2.0), DVec2::new(0.0, 2.0)];
/// assert_eq!(signed_area(&square), 4.0);
/// let clockwise: Vec<DVec2> = square.into_iter().rev().collect();
/// assert_eq!(signed_area(&clockwise), -4.0);
/// ```
pub fn signed_area(vertices: &[DVec2]) -> f64 {
    let Some(&origin) = vertices.first() else { return 0.0 };
    0.5 * edges(vertices).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>()
}

/// Returns the corners of a regular polygon around the origin, counter-clockwise. The first corner is on the x axis.
///
/// ```
/// use envgen::geometry::{regular_polygon, signed_area};
///
/// let square = regular_polygon(2.0, 4);
/// assert!((signed_area(&square) - 8.0).abs() < 1e-12);
/// ```
pub fn regular_polygon(radius: f64, sides: usize) -> Vec<DVec2> {
    let corner = |i| unit_vector(std::f64::consts::TAU * i as f64 / sides as f64) * radius;
    (0..sides).map(corner).collect()
}

/// Whether a point lies inside a polygon, by the even-odd rule. A point on a side that two polygons share lies in one
/// of them. Not to be changed lightly: frozen digests of maps and trials depend on it.
pub(crate) fn polygon_contains(vertices: &[DVec2], p: DVec2) -> bool {
    edges(vertices).fold(false, |inside, (a, b)| {
        let crosses =
            (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x;
        inside != crosses
    })
}
