//! Division of polygons into convex pieces.

use std::collections::BTreeMap;

use glam::DVec2;

use super::triangulate;

/// Divides a simple, counter-clockwise polygon into convex pieces without new corners: its triangles, joined over
/// every side that they share if the result is convex. There are at most four times as many pieces as the least
/// possible number (S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons", 1983,
/// `doi:10.1007/3-540-12689-9_105`). A piece is a list of corners, counter-clockwise.
///
/// Returns `None` if [`triangulate`] does.
pub fn convex_pieces(outline: &[DVec2]) -> Option<Vec<Vec<u32>>> {
    let mut pieces: Vec<Vec<u32>> = triangulate(outline)?.into_iter().map(Vec::from).collect();
    let sides = |piece: &[u32]| -> Vec<[u32; 2]> {
        (0..piece.len()).map(|i| [piece[i], piece[(i + 1) % piece.len()]]).collect()
    };
    let mut owner = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        owner.extend(sides(piece).into_iter().map(|side| (side, i)));
    }
    let shared: Vec<[u32; 2]> =
        owner.keys().copied().filter(|&[a, b]| a < b && owner.contains_key(&[b, a])).collect();
    for [a, b] in shared {
        let (one, other) = (owner[&[a, b]], owner[&[b, a]]);
        // From b round to before a, and from a round to before b.
        let [mut joined, rest] = [(one, b), (other, a)].map(|(piece, first)| {
            let mut corners = pieces[piece].clone();
            let at = corners.iter().position(|&corner| corner == first).unwrap_or(0);
            corners.rotate_left(at);
            corners.pop();
            corners
        });
        let seam = joined.len();
        joined.extend(rest);
        let n = joined.len();
        let is_convex = |i: usize| {
            let [p, q, r] = [i + n - 1, i, i + 1].map(|i| outline[joined[i % n] as usize]);
            (q - p).perp_dot(r - q) >= 0.0
        };
        if is_convex(0) && is_convex(seam) {
            owner.extend(sides(&pieces[other]).into_iter().map(|side| (side, one)));
            pieces[other].clear();
            pieces[one] = joined;
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    Some(pieces)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{edges, signed_area, unit_vector};

    #[test]
    fn convex_polygons_stay_whole() {
        let corner = |i: usize| unit_vector(std::f64::consts::TAU * i as f64 / 7.0);
        let outline: Vec<DVec2> = (0..7).map(corner).collect();
        assert_eq!(convex_pieces(&outline).unwrap().len(), 1);
    }

    proptest! {
        #[test]
        fn pieces_are_convex_and_cover_the_polygon(radii in proptest::collection::vec(0.1..10.0, 3..40)) {
            let n = radii.len() as f64;
            let corner = |(i, radius): (usize, &f64)| unit_vector(std::f64::consts::TAU * i as f64 / n) * *radius;
            let outline: Vec<DVec2> = radii.iter().enumerate().map(corner).collect();
            let pieces = convex_pieces(&outline).unwrap();
            let mut area = 0.0;
            for piece in &pieces {
                let corners: Vec<DVec2> = piece.iter().map(|&i| outline[i as usize]).collect();
                area += signed_area(&corners);
                for (a, b) in edges(&corners) {
                    prop_assert!(corners.iter().all(|&p| (b - a).perp_dot(p - a) >= -1e-9));
                }
            }
            prop_assert!((area - signed_area(&outline)).abs() < 1e-9 * area);
        }
    }
}
