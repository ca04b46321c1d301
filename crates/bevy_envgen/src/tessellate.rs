//! Triangulation of simple polygons.

use bevy::math::Vec2;
use earcut::Earcut;

/// Splits a simple polygon into counter-clockwise triangles and returns the indices of their corners.
/// Triangles without an area, which collinear corners cause, are left out. It does not use
/// `envgen::mesh::triangulate`, which rejects outlines that touch themselves, as narrow ones do in single
/// precision.
pub(crate) fn triangles(polygon: &[Vec2]) -> Vec<[u32; 3]> {
    let mut corners: Vec<u32> = Vec::new();
    Earcut::new().earcut(polygon.iter().map(|p| p.as_dvec2().to_array()), &[], &mut corners);
    let triangles = corners.as_chunks::<3>().0.iter();
    triangles
        .filter_map(|&[a, b, c]| {
            let [p, q, r] = [a, b, c].map(|i| polygon[i as usize].as_dvec2());
            let area = (q - p).perp_dot(r - p);
            (area != 0.0).then_some(if area > 0.0 { [a, b, c] } else { [a, c, b] })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use envgen::geometry::signed_area;

    fn area(polygon: &[Vec2], triangles: &[[u32; 3]]) -> f64 {
        let corner = |i: u32| polygon[i as usize].as_dvec2();
        triangles.iter().map(|t| signed_area(&t.map(corner))).sum()
    }

    #[test]
    fn triangles_fill_the_polygon() {
        let points = |list: &[(f32, f32)]| list.iter().map(|p| Vec2::from(*p)).collect::<Vec<_>>();
        for polygon in [
            points(&[(0., 0.), (4., 0.), (4., 3.), (0., 3.)]),
            points(&[(0., 0.), (4., 0.), (4., 1.), (1., 1.), (1., 3.), (0., 3.)]),
            points(&[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (3., 2.), (1.5, 2.), (0., 2.)]),
            points(&[
                (0., 0.),
                (5., 0.),
                (5., 5.),
                (4., 5.),
                (4., 1.),
                (1., 1.),
                (1., 5.),
                (0., 5.),
            ]),
        ] {
            let corners: Vec<_> = polygon.iter().map(|p| p.as_dvec2()).collect();
            let filled = area(&polygon, &triangles(&polygon));
            assert!((filled - signed_area(&corners)).abs() < 1e-6, "{polygon:?}");
        }
        assert!(triangles(&[]).is_empty());
        assert!(triangles(&points(&[(0., 0.), (1., 0.), (2., 0.)])).is_empty());
    }
}
