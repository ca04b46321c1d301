//! Simple polygons, given by their corners.

use glam::DVec2;

/// The sides of a closed polygon.
pub fn edges(vertices: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    vertices.iter().copied().zip(vertices.iter().copied().cycle().skip(1))
}

/// The area of a polygon in square metres, positive when it runs counter-clockwise.
pub fn signed_area(vertices: &[DVec2]) -> f64 {
    let Some(&origin) = vertices.first() else { return 0.0 };
    0.5 * edges(vertices).map(|(a, b)| (a - origin).perp_dot(b - origin)).sum::<f64>()
}

/// Whether a point lies inside a polygon, by the even-odd rule.
pub(crate) fn polygon_contains(vertices: &[DVec2], p: DVec2) -> bool {
    edges(vertices).fold(false, |inside, (a, b)| {
        let crosses =
            (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x;
        inside != crosses
    })
}
