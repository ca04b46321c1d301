//! Metrics of a forest, and the values that theory predicts for them.

use std::f64::consts::PI;

use glam::DVec2;
use serde::Serialize;

use super::blueprint::Forest;
use super::index::CellList;
use super::predict;
use super::spec::{Border, ForestSpec, RadiusLaw};
use crate::geometry::{Rect, Shape};
use crate::occupancy::{Coverage, OccupancyGrid};
use crate::union_find::UnionFind;
use crate::world::Tree;

/// The percolation threshold of the reduced density. Discs of equal radius r and intensity lambda percolate at
/// lambda pi r^2 = 1.128: beyond this, they form an infinite cluster (J. Quintanilla, S. Torquato and R. M. Ziff,
/// Efficient measurement of the percolation threshold for fully penetrable discs, J. Phys. A 33, 2000,
/// <https://doi.org/10.1088/0305-4470/33/42/104>).
pub const PERCOLATION_THRESHOLD: f64 = 1.128;

/// Approximate number of cells along the longer side of the raster on which the cover is measured.
const COVER_CELLS: f64 = 256.0;

/// The least number of cells across the area, unless this gives too many cells in total.
const NARROW_CELLS: f64 = 16.0;
const MOST_COVER_CELLS: f64 = (1 << 22) as f64;

/// The metrics of a forest. On a torus, cover, touching trunks and nearest neighbours count across the area's
/// sides; crossings do not.
///
/// Predictions are those of the Poisson process with the spec's intensity and radii. They are absent if the density
/// varies or the distribution of radii is not the spec's; a least distance or clearings make them inaccurate. They
/// predict the mean over many forests, and account for the border: trees near it have no neighbours beyond it, and
/// fewer trunks cover the ground there. The formulas given below are those of an endless forest.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// // 0.05 trees per square metre on 50 m by 50 m.
/// let forest = ForestSpec::default().generate(Seed(7))?;
/// let metrics = forest.metrics();
/// assert_eq!(metrics.count, forest.trees().len() as u64);
/// assert_eq!(metrics.count_predicted, Some(125.0));
/// assert!((0.0..1.0).contains(&metrics.cover));
/// # Ok::<(), envgen::forest::ForestError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ForestMetrics {
    /// Number of trees.
    pub count: u64,
    /// Number of trees that the intensity predicts.
    pub count_predicted: Option<f64>,
    /// Number of trees that were removed to make the clearings.
    pub cleared: u64,
    /// Share of the area that is covered by trunks.
    pub cover: f64,
    /// Predicted share: 1 - exp(-lambda pi E[r^2]) in an endless forest, less with a border.
    pub cover_predicted: Option<f64>,
    /// Share of trees whose trunk touches no other trunk; absent without trees.
    pub untouched: Option<f64>,
    /// Predicted share: exp(-4 lambda pi r^2) in an endless forest of a fixed radius r, more with a border. Absent
    /// for other distributions of radii.
    pub untouched_predicted: Option<f64>,
    /// Mean distance from a tree's centre to the nearest other tree's centre in metres; absent for fewer than two
    /// trees.
    pub nearest_neighbour: Option<f64>,
    /// Predicted distance: 1 / (2 sqrt lambda) in an endless forest. It is greater with a border, and because the
    /// number of trees is random: the mean distance grows more with fewer trees than it falls with more trees.
    pub nearest_neighbour_predicted: Option<f64>,
    /// Predicted mean free path, in metres, of a robot that drives straight in an endless forest:
    /// `1 / (2 lambda (E[r] + rho))`, where rho is the robot's radius.
    pub free_path_predicted: Option<f64>,
    /// The reduced density lambda pi E[(r + rho)^2]: above [`PERCOLATION_THRESHOLD`], a wide and even forest of equal
    /// trunks cannot be crossed. It uses the spec's own intensity, whatever the density map is, and means over the
    /// trees if the distribution of radii is not the spec's.
    pub reduced_density: f64,
    /// Whether a wide forest of this reduced density is predicted to be crossable. Absent where the density
    /// varies or the radii are not the spec's, and above the threshold if radii differ: then discs percolate at a higher
    /// density, which is not known in general.
    pub traversable_predicted: Option<bool>,
    /// Whether the robot's centre can move from the west side of the area to its east side without leaving the area.
    pub traversable: bool,
}

pub(super) fn measure(forest: &Forest) -> ForestMetrics {
    let (spec, trees) = (forest.spec(), forest.trees());
    let size = spec.centre_area().size();
    let lambda = spec.intensity;
    let fixed = spec.radius_law == RadiusLaw::Fixed;
    // The theory holds for forests of even density.
    let is_even = lambda > 0.0 && spec.density.is_none() && !forest.edited();
    let even = |value: fn(&ForestSpec) -> f64| {
        is_even.then(|| value(spec)).filter(|value| value.is_finite())
    };
    let (untouched, nearest_neighbour) = neighbours(spec, trees);
    ForestMetrics {
        count: trees.len() as u64,
        count_predicted: is_even.then_some(lambda * size.x * size.y),
        cleared: forest.cleared(),
        cover: cover(spec, trees),
        cover_predicted: even(predict::cover),
        untouched,
        untouched_predicted: even(predict::untouched).filter(|_| fixed),
        nearest_neighbour,
        nearest_neighbour_predicted: even(predict::nearest_neighbour),
        free_path_predicted: even(free_path),
        reduced_density: reduced_density(forest),
        traversable_predicted: predicts_crossing(forest),
        traversable: crosses_west_east(forest),
    }
}

/// Returns the mean free path of a robot that drives straight in an endless forest.
fn free_path(spec: &ForestSpec) -> f64 {
    let (mean, _) = radius_moments(spec);
    0.5 / (spec.intensity * (mean + spec.robot_radius))
}

/// Returns lambda pi E[(r + rho)^2], the mean number of trunks, enlarged by the robot's radius, that cover a point.
fn reduced_density(forest: &Forest) -> f64 {
    let spec = forest.spec();
    let (mean, mean_square) =
        if forest.custom_radii { mean_radii(forest.trees()) } else { radius_moments(spec) };
    let rho = spec.robot_radius;
    spec.intensity * PI * (mean_square + 2.0 * mean * rho + rho * rho)
}

/// Whether a wide forest of this density is predicted to be crossable; `None` if nothing is predicted.
pub(super) fn predicts_crossing(forest: &Forest) -> Option<bool> {
    let spec = forest.spec();
    if spec.density.is_some() || forest.edited() {
        return None;
    }
    let is_below = reduced_density(forest) < PERCOLATION_THRESHOLD;
    (is_below || spec.radius_law == RadiusLaw::Fixed).then_some(is_below)
}

/// Returns the means of r and r^2 over trees; 0 without trees.
fn mean_radii(trees: &[Tree]) -> (f64, f64) {
    let n = trees.len().max(1) as f64;
    let sum = |power: fn(f64) -> f64| trees.iter().map(|tree| power(tree.radius)).sum::<f64>();
    (sum(|r| r) / n, sum(|r| r * r) / n)
}

/// Returns E[r] and E[r^2] of the distribution of radii.
fn radius_moments(spec: &ForestSpec) -> (f64, f64) {
    let (a, b) = (spec.radius_min, spec.radius_max);
    match spec.radius_law {
        RadiusLaw::Fixed => (spec.radius, spec.radius * spec.radius),
        RadiusLaw::Uniform => (0.5 * (a + b), (a * a + a * b + b * b) / 3.0),
        RadiusLaw::LogNormal => {
            // E[r^k; a < r < b] = m^k exp(k^2 s^2 / 2) (Phi(z_b - k s) - Phi(z_a - k s)).
            let (m, s) = (spec.radius, spec.radius_sigma);
            let normal_cdf = |z: f64| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
            let z = |r: f64| libm::log(r / m) / s;
            let part = |k: f64| {
                libm::pow(m, k)
                    * libm::exp(0.5 * k * k * s * s)
                    * (normal_cdf(z(b) - k * s) - normal_cdf(z(a) - k * s))
            };
            (part(1.0) / part(0.0), part(2.0) / part(0.0))
        }
    }
}

/// Returns the share of trees that touch no other tree, and the mean distance to the nearest neighbour.
fn neighbours(spec: &ForestSpec, trees: &[Tree]) -> (Option<f64>, Option<f64>) {
    if trees.is_empty() {
        return (None, None);
    }
    let largest = trees.iter().map(|tree| tree.radius).fold(0.0, f64::max);
    let size = spec.area().size();
    let spacing = (size.x * size.y / trees.len() as f64).sqrt();
    let torus = spec.border == Border::Torus;
    let placed = by_place(spec, trees);
    let centers = || placed.iter().map(|tree| tree.center);
    let near = CellList::of(spec.area(), spacing, torus, centers());
    let touching = CellList::of(spec.area(), 2.0 * largest, torus, centers());
    let mut untouched = 0_u64;
    let mut distances = vec![0.0; trees.len()];
    for (i, tree) in placed.iter().enumerate() {
        let touched = touching.any(tree.center, |j, offset| {
            let reach = tree.radius + placed[j as usize].radius;
            j as usize != i && offset.length_squared() < reach * reach
        });
        untouched += u64::from(!touched);
        distances[tree.number as usize] = near.nearest(tree.center, i as u32);
    }
    let (n, sum) = (trees.len() as f64, distances.iter().sum::<f64>());
    (Some(untouched as f64 / n), (trees.len() > 1).then_some(sum / n))
}

/// A tree in the order of [`by_place`].
struct Placed {
    center: DVec2,
    radius: f64,
    /// Its number in the forest.
    number: u32,
}

/// Returns the trees in an order in which most are near those before them. Look-ups in this order find their trees in
/// a processor's cache.
fn by_place(spec: &ForestSpec, trees: &[Tree]) -> Vec<Placed> {
    /// Mean number of trees along a cell's side.
    const TREES: f64 = 4.0;
    let (area, size) = (spec.area(), spec.area().size());
    let side = TREES * (size.x * size.y / trees.len() as f64).sqrt();
    let cell = |tree: &Tree| {
        let cell = (tree.center - area.min) / side;
        (cell.y as u32, cell.x as u32)
    };
    let mut order: Vec<_> = (0_u32..).zip(trees).map(|(i, tree)| (cell(tree), i)).collect();
    order.sort_unstable();
    let placed = |(_, number): &(_, u32)| {
        let Tree { center, radius, .. } = trees[*number as usize];
        Placed { center, radius, number: *number }
    };
    order.iter().map(placed).collect()
}

/// Returns the share of the area under trunks, measured at the cell centres of a raster. On a torus, trunks extend
/// across the sides.
fn cover(spec: &ForestSpec, trees: &[Tree]) -> f64 {
    let (area, size) = (spec.area(), spec.area().size());
    let (usual, narrow) = (size.max_element() / COVER_CELLS, size.min_element() / NARROW_CELLS);
    // A narrow area has some rows as well, unless they were too many cells.
    let least = (size.x * size.y / MOST_COVER_CELLS).sqrt();
    let side = usual.min(narrow.max(least).max(size.max_element() / MOST_COVER_CELLS));
    // A single row is along the middle.
    let beyond = (0.5 * (DVec2::splat(side) - size)).max(DVec2::ZERO);
    let framed = Rect::new(area.min - beyond, area.max + beyond);
    let Ok(mut grid) = OccupancyGrid::empty(framed, side) else { return 0.0 };
    let copies: &[f64] = if spec.border == Border::Torus { &[-1.0, 0.0, 1.0] } else { &[0.0] };
    for tree in trees {
        for offset in copies.iter().flat_map(|&i| copies.iter().map(move |&j| DVec2::new(i, j))) {
            let trunk = Shape::Disc { center: tree.center + size * offset, radius: tree.radius };
            grid.occupy(&trunk, Coverage::Centre);
        }
    }
    // The last row or column of cells may lie outside the area.
    let mut inside = 0_u32;
    let mut covered = 0_u32;
    for row in 0..grid.rows() {
        for col in 0..grid.cols() {
            if area.contains(grid.cell_centre(col, row)) {
                inside += 1;
                covered += u32::from(grid.occupied(col, row) == Some(true));
            }
        }
    }
    f64::from(covered) / f64::from(inside.max(1))
}

/// Whether the centre of a disc-shaped robot can move from the west side of the area to its east side without
/// leaving the area.
///
/// The test is exact: the robot cannot cross if and only if trunks enlarged by its radius form an overlapping chain
/// from the south side to the north side. It uses union-find over the overlapping trunks, in time nearly linear in
/// their number.
pub(super) fn crosses_west_east(forest: &Forest) -> bool {
    let (spec, trees) = (forest.spec(), forest.trees());
    let rho = spec.robot_radius;
    let largest = trees.iter().map(|tree| tree.radius).fold(0.0, f64::max);
    let reach = 2.0 * (largest + rho);
    let trees = by_place(spec, trees);
    let grid = CellList::of(spec.area(), reach, false, trees.iter().map(|tree| tree.center));
    let (south, north) = (trees.len(), trees.len() + 1);
    let mut sets = UnionFind::new(trees.len() + 2);
    for (i, tree) in trees.iter().enumerate() {
        if sets.is_joined(south, north) {
            return false;
        }
        let grown = tree.radius + rho;
        if tree.center.y - grown < 0.0 {
            sets.join(i, south);
        }
        if tree.center.y + grown > spec.height {
            sets.join(i, north);
        }
        grid.visit(tree.center, |j, offset| {
            let other = &trees[j as usize];
            // Rounded in the same order for every order of the trees.
            let [first, last] =
                if tree.number < other.number { [tree, other] } else { [other, tree] };
            let reach = last.radius + rho + first.radius + rho;
            if (j as usize) < i && offset.length_squared() < reach * reach {
                sets.join(i, j as usize);
            }
        });
    }
    !sets.is_joined(south, north)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forest::density::DensityMap;
    use crate::generate::{Blueprint, Spec};
    use crate::seed::Seed;

    /// Returns a forest of a reduced density for points as robots.
    fn forest(spec: ForestSpec, reduced_density: f64) -> Forest {
        let spec = ForestSpec { robot_radius: 0.0, intensity: 1.0, ..spec };
        let (_, mean_square) = radius_moments(&spec);
        let intensity = reduced_density / (PI * mean_square);
        ForestSpec { intensity, ..spec }.generate(Seed(1)).unwrap()
    }

    #[test]
    fn crossing_is_predicted_where_theory_knows() {
        let fixed = ForestSpec { radius: 0.3, ..Default::default() };
        assert_eq!(predicts_crossing(&forest(fixed.clone(), 1.0)), Some(true));
        assert_eq!(predicts_crossing(&forest(fixed, 1.2)), Some(false));
        // Discs of different radii percolate at a higher density: this forest can be crossed.
        let mixed = ForestSpec {
            width: 120.0,
            height: 120.0,
            radius_law: RadiusLaw::LogNormal,
            radius: 0.2,
            radius_sigma: 1.0,
            radius_min: 0.001,
            radius_max: 3.0,
            ..Default::default()
        };
        assert_eq!(predicts_crossing(&forest(mixed.clone(), 1.0)), Some(true));
        let dense = forest(mixed, 1.17).metrics();
        assert_eq!((dense.traversable_predicted, dense.traversable), (None, true));
        // The map multiplies the intensity: this forest is five times as dense as the spec says.
        let varied = ForestSpec {
            density: Some(DensityMap { rows: vec![vec![5.0]] }),
            ..Default::default()
        };
        assert_eq!(predicts_crossing(&varied.generate(Seed(1)).unwrap()), None);
    }
}
