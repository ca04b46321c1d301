//! A test whether a polygon is simple, in about n log n steps for n corners.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::DVec2;

use crate::geometry::segments_cross;

/// Whether no two sides of a polygon touch, except neighbours at their common corner. A sweep over the sides finds
/// the first two that do (Shamos and Hoey, Geometric intersection problems, 1976,
/// <https://doi.org/10.1109/SFCS.1976.16>).
pub(crate) fn is_simple(vertices: &[DVec2]) -> bool {
    let n = vertices.len();
    if n < 3 || !vertices.iter().all(|corner| corner.is_finite()) {
        return false;
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| in_order(vertices[a], vertices[b]));
    if order.windows(2).any(|pair| vertices[pair[0]] == vertices[pair[1]]) {
        return false;
    }
    let side = |index: usize| Side::new(vertices, index);
    let touch = |a: Option<&Side>, b: Option<&Side>| {
        a.zip(b).is_some_and(|(a, b)| touch(vertices, a.index, b.index))
    };
    // The sides that the sweep is in, from below.
    let mut swept: BTreeSet<Side> = BTreeSet::new();
    for corner in order {
        let sides = [(corner + n - 1) % n, corner].map(side);
        for side in sides.iter().filter(|side| side.high == vertices[corner]) {
            if !swept.remove(side) {
                // Rounding has put sides that all but touch out of order.
                swept.retain(|other| other.index != side.index);
            }
            if touch(swept.range(..side).next_back(), swept.range(side..).next()) {
                return false;
            }
        }
        for side in sides.into_iter().filter(|side| side.low == vertices[corner]) {
            if touch(swept.range(..&side).next_back(), Some(&side))
                || touch(Some(&side), swept.range(&side..).next())
            {
                return false;
            }
            swept.insert(side);
        }
    }
    true
}

/// Orders points from left to right, and those with equal x from bottom to top.
fn in_order(a: DVec2, b: DVec2) -> Ordering {
    // Finite, and -0 is 0.
    let order = |a: f64, b: f64| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    order(a.x, b.x).then(order(a.y, b.y))
}

/// Whether two sides have more in common than the shared corner of neighbours.
fn touch(vertices: &[DVec2], i: usize, j: usize) -> bool {
    let n = vertices.len();
    let corner = |i: usize| vertices[i % n];
    let folds_back = |i: usize| {
        let (before, after) = (corner(i + 1) - corner(i), corner(i + 2) - corner(i + 1));
        before.perp_dot(after) == 0.0 && before.dot(after) < 0.0
    };
    if (i + 1) % n == j {
        folds_back(i)
    } else if (j + 1) % n == i {
        folds_back(j)
    } else {
        segments_cross(corner(i), corner(i + 1), corner(j), corner(j + 1))
    }
}

/// A side, with its ends in order.
#[derive(Clone, Copy, Debug)]
struct Side {
    index: usize,
    low: DVec2,
    high: DVec2,
}

impl Side {
    fn new(vertices: &[DVec2], index: usize) -> Self {
        let (a, b) = (vertices[index], vertices[(index + 1) % vertices.len()]);
        let (low, high) = if in_order(a, b).is_lt() { (a, b) } else { (b, a) };
        Side { index, low, high }
    }

    /// Compares the heights of two sides, of which this one begins first.
    fn cmp_later(&self, later: &Side) -> Ordering {
        let above = |p: DVec2| {
            let height = (self.high - self.low).perp_dot(p - self.low);
            0.0_f64.partial_cmp(&height).unwrap_or(Ordering::Equal)
        };
        above(later.low).then_with(|| above(later.high))
    }
}

impl Ord for Side {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.index == other.index {
            return Ordering::Equal;
        }
        let order = match in_order(self.low, other.low).is_gt() {
            false => self.cmp_later(other),
            true => other.cmp_later(self).reverse(),
        };
        order.then(self.index.cmp(&other.index))
    }
}

impl PartialOrd for Side {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Side {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Side {}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::unit_vector;

    /// Every side against every other.
    fn plainly(vertices: &[DVec2]) -> bool {
        let n = vertices.len();
        let equal = |i: usize, j: usize| vertices[i] == vertices[j];
        n >= 3 && (0..n).all(|i| (i + 1..n).all(|j| !equal(i, j) && !touch(vertices, i, j)))
    }

    proptest! {
        /// Corners on a grid, where many sides touch, are in line or upright.
        #[test]
        fn polygons_on_a_grid_are_judged_as_by_all_pairs(
            corners in prop::collection::vec((0..6_i32, 0..6_i32), 0..9),
        ) {
            let corners: Vec<DVec2> =
                corners.into_iter().map(|(x, y)| DVec2::new(x.into(), y.into())).collect();
            prop_assert_eq!(is_simple(&corners), plainly(&corners));
        }

        /// Stars, of which some are pulled across themselves.
        #[test]
        fn stars_are_judged_as_by_all_pairs(
            radii in prop::collection::vec(0.1..2.0_f64, 3..40),
            pulled in 0..40_usize,
            to in (-2.0..2.0_f64, -2.0..2.0_f64),
            turn in prop::option::of(-4.0..4.0_f64),
        ) {
            let step = std::f64::consts::TAU / radii.len() as f64;
            let turn = turn.unwrap_or(0.0);
            let mut corners: Vec<DVec2> = radii
                .iter()
                .enumerate()
                .map(|(i, &radius)| unit_vector(turn + step * i as f64) * radius)
                .collect();
            if let Some(corner) = corners.get_mut(pulled) {
                *corner = to.into();
            }
            prop_assert_eq!(is_simple(&corners), plainly(&corners));
        }
    }

    /// A comb with teeth of 1 km in a direction.
    fn comb(teeth: usize, heading: f64) -> Vec<DVec2> {
        let along = unit_vector(heading);
        let corner = |along_m: f64, beside_m: f64| along * along_m + along.perp() * beside_m;
        let tooth = |i: usize| {
            let beside = i as f64;
            [corner(1000.0, beside), corner(1000.0, beside + 0.4), corner(1.0, beside + 0.4)]
                .into_iter()
                .chain([corner(1.0, beside + 1.0)])
        };
        let mut corners = vec![corner(0.0, 0.0)];
        corners.extend((0..teeth).flat_map(tooth));
        corners.push(corner(0.0, teeth as f64));
        corners
    }

    /// All pairs are 8e10.
    #[test]
    fn large_combs_are_judged_at_once() {
        for heading in [0.0, 1.0, std::f64::consts::FRAC_PI_2, 2.5] {
            let mut corners = comb(100_000, heading);
            assert!(is_simple(&corners), "{heading}");
            // The end of a tooth is pulled across the next one.
            let along = unit_vector(heading);
            corners[200_002] += along.perp() * 0.7;
            assert!(!is_simple(&corners), "{heading}");
        }
    }
}
