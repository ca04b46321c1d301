//! Division of polygons into triangles.
//!
//! It uses `spade`, which keeps every corner and refuses outlines that touch themselves, because solids must be
//! closed. The reader of GeoJSON and the colliders of `bevy_envgen` use `earcut`, which leaves corners out and
//! fills whatever it receives: rings may touch each other there, and outlines in single precision touch themselves.

use glam::DVec2;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

/// Divides a simple, counter-clockwise polygon into the triangles of its constrained Delaunay triangulation. The
/// triangles use all its corners, including those between two sides of one line, so that the triangles of an
/// outline and the faces that join its sides meet edge to edge. It takes about n log n steps for n corners.
///
/// Returns `None` if a side touches or crosses another one, or if a coordinate is not finite or above 2^201.
pub fn triangulate(outline: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    let n = outline.len();
    if n < 3 {
        return None;
    }
    let points = outline.iter().map(|p| mitigate_underflow(Point2::new(p.x, p.y))).collect();
    let sides = (0..n).map(|i| [i, (i + 1) % n]).collect();
    let mut is_simple = true;
    let divided: ConstrainedDelaunayTriangulation<Point2<f64>> =
        ConstrainedDelaunayTriangulation::try_bulk_load_cdt(points, sides, |_| is_simple = false)
            .ok()?;
    if !is_simple || divided.num_vertices() != n {
        return None;
    }
    // Inside are the faces left of the sides, and all that are joined to them without crossing a side.
    let mut is_inside = vec![false; divided.num_all_faces()];
    let mut next = Vec::new();
    for i in 0..n {
        let [from, to] = [i, (i + 1) % n].map(FixedVertexHandle::from_index);
        next.push(divided.get_edge_from_neighbors(from, to)?.face().as_inner()?);
    }
    let mut triangles = Vec::with_capacity(n - 2);
    while let Some(face) = next.pop() {
        if std::mem::replace(&mut is_inside[face.index()], true) {
            continue;
        }
        triangles.push(face.vertices().map(|corner| corner.index() as u32));
        for side in face.adjacent_edges().into_iter().filter(|side| !side.is_constraint_edge()) {
            next.push(side.rev().face().as_inner()?);
        }
    }
    // A simple polygon falls into two triangles fewer than it has corners.
    (triangles.len() == n - 2).then_some(triangles)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{signed_area, unit_vector};

    fn polygon(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    fn area(outline: &[DVec2], triangles: &[[u32; 3]]) -> f64 {
        triangles
            .iter()
            .map(|corners| {
                let area = signed_area(&corners.map(|i| outline[i as usize]));
                assert!(area > 0.0, "{corners:?}");
                area
            })
            .sum()
    }

    #[test]
    fn corners_on_a_straight_side_are_kept() {
        let bar = polygon(&[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (3., 1.), (1., 1.), (0., 1.)]);
        let triangles = triangulate(&bar).unwrap();
        assert_eq!((triangles.len(), area(&bar, &triangles)), (5, 3.0));
    }

    #[test]
    fn what_is_no_simple_polygon_has_no_triangles() {
        for wrong in [
            polygon(&[(0., 0.), (1., 0.)]),
            polygon(&[(0., 0.), (1., 0.), (2., 0.)]),
            polygon(&[(0., 0.), (1., 1.), (1., 0.), (0., 1.)]),
            polygon(&[(0., 0.), (4., 0.), (4., 4.), (2., 0.), (0., 4.)]),
            polygon(&[(0., 0.), (0., 1.), (1., 1.), (1., 0.)]),
            polygon(&[(0., 0.), (1., 0.), (1., 0.), (1., 1.)]),
            polygon(&[(0., 0.), (f64::NAN, 0.), (1., 1.)]),
            polygon(&[(0., 0.), (1e300, 0.), (1., 1e300)]),
        ] {
            assert_eq!(triangulate(&wrong), None, "{wrong:?}");
        }
    }

    proptest! {
        #[test]
        fn triangles_cover_the_polygon(radii in proptest::collection::vec(0.1..10.0, 3..60)) {
            // A star around the origin is simple.
            let n = radii.len() as f64;
            let corner = |(i, radius): (usize, &f64)| unit_vector(std::f64::consts::TAU * i as f64 / n) * *radius;
            let outline: Vec<DVec2> = radii.iter().enumerate().map(corner).collect();
            let triangles = triangulate(&outline).unwrap();
            prop_assert_eq!(triangles.len(), outline.len() - 2);
            let whole = signed_area(&outline);
            prop_assert!((area(&outline, &triangles) - whole).abs() < 1e-9 * whole);
        }
    }
}
