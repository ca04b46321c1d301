//! The five metrics of BARN.

use super::feature::features;
use crate::distance::{assert_whole_rows, squared_distances};

/// The greatest distance in cells of an obstacle that counts for the dispersion.
const RADIUS: u32 = 3;

/// The rays of the dispersion in their circular order, as rows and columns.
const RAYS: [(isize, isize); 16] = [
    (0, 1),
    (1, 2),
    (1, 1),
    (2, 1),
    (1, 0),
    (2, -1),
    (1, -1),
    (1, -2),
    (0, -1),
    (-1, -2),
    (-1, -1),
    (-2, -1),
    (-1, 0),
    (-2, 1),
    (-1, 1),
    (-1, 2),
];

/// The two rays that are in the wrong order in the published code.
const SWAPPED: (usize, usize) = (9, 11);

/// The axes of the characteristic dimension.
const AXES: [(isize, isize); 4] = [(0, 1), (1, 1), (1, 0), (1, -1)];

/// The variants of computing BARN's metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BarnMode {
    /// As in the code that BARN published. For the dispersion, slope rays with a component of -2 reach three jumps
    /// far, those with +2 only two, and two of them are in the wrong circular order, so that the metric is not
    /// symmetric. In a map without obstacles, the distance to the closest obstacle is half the number of rows. The
    /// visibility counts the own cell once for each ray.
    Reference,
    /// All slope rays reach two jumps far and are in order. Without obstacles, the distance to the closest obstacle
    /// does not exist. The visibility does not count the own cell.
    Corrected,
}

/// The five metrics of BARN, which describe a path through a grid: D. Perille, A. Truong, X. Xiao and
/// P. Stone, Benchmarking Metric Ground Navigation, SSRR 2020, arXiv:2008.13315.
///
/// ```
/// use envgen::difficulty::{BarnMetrics, BarnMode};
///
/// // A corridor of three rows whose outer ones are blocked, from its left to its right end.
/// let blocked: Vec<bool> = (0..15).map(|cell| cell / 5 != 1).collect();
/// let path = [5, 6, 7, 8, 9];
/// let metrics = BarnMetrics::of(5, &blocked, &path, BarnMode::Reference).expect("a path");
/// assert_eq!(metrics.closest_obstacle_cells, Some(1.0));
/// assert_eq!(metrics.characteristic_dimension_cells, 0.0);
/// assert_eq!(metrics.tortuosity, Some(1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarnMetrics {
    /// Mean distance to the closest blocked cell, in cells, at most 256. It is greater for easier paths.
    pub closest_obstacle_cells: Option<f64>,
    /// Mean over the path of the mean free length of the eight compass rays, in cells.
    pub visibility_cells: f64,
    /// Mean number of changes between free and blocked, from 0 to 16, among 16 rays around a cell.
    pub dispersion: f64,
    /// Mean over the path of the least free length along four axes, without the own cell, in cells.
    pub characteristic_dimension_cells: f64,
    /// Length of the path divided by the distance between its ends; `None` if both ends are the same cell.
    pub tortuosity: Option<f64>,
}

impl BarnMetrics {
    /// Computes the metrics of a path over a grid of `cols` columns. `blocked` marks, row by row, the cells of
    /// C-space in which the robot cannot be. The path is a list of cell indices. Returns `None` for an empty path.
    ///
    /// # Panics
    /// When the cells do not fill whole rows, or when the path leaves the grid.
    #[track_caller]
    pub fn of(cols: usize, blocked: &[bool], path: &[usize], mode: BarnMode) -> Option<Self> {
        assert_whole_rows(blocked.len(), cols);
        if let Some(cell) = path.iter().find(|&&cell| cell >= blocked.len()) {
            panic!("cell {cell} of the path is not one of {} cells", blocked.len());
        }
        Grid::new(cols, blocked).metrics(path, mode)
    }
}

/// A grid with its blocked cells.
struct Grid<'a> {
    cols: isize,
    rows: isize,
    blocked: &'a [bool],
    /// Squared distance of every cell to the closest blocked cell, in cells; empty if no cell is blocked.
    squared: Vec<u16>,
    /// For each of [`AXES`], the length of the run of free cells along it that contains a cell; 0 for blocked cells.
    runs: [Vec<u32>; 4],
}

impl<'a> Grid<'a> {
    fn new(cols: usize, blocked: &'a [bool]) -> Self {
        let squared = match blocked.contains(&true) {
            true => squared_distances(cols, blocked),
            false => Vec::new(),
        };
        let rows = blocked.len().checked_div(cols).unwrap_or(0);
        let runs = AXES.map(|axis| runs(cols, blocked, axis));
        Grid { cols: cols as isize, rows: rows as isize, blocked, squared, runs }
    }

    fn metrics(&self, path: &[usize], mode: BarnMode) -> Option<BarnMetrics> {
        let (&first, &last) = (path.first()?, path.last()?);
        let mut sums = [0.0; 4];
        for &cell in path {
            let squared = self.squared.get(cell).copied().unwrap_or(0);
            let (visibility, dimension) = self.free_lengths(cell, mode);
            let dispersion = self.dispersion(cell, mode);
            let values = [f64::from(squared).sqrt(), visibility, dispersion, dimension];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        let [closest, visibility, dispersion, dimension] = sums.map(|sum| sum / path.len() as f64);
        let closest_obstacle_cells = match (self.squared.is_empty(), mode) {
            (false, _) => Some(closest),
            // In whole numbers, as in the published code.
            (true, BarnMode::Reference) => Some(((self.rows - 1) / 2) as f64),
            (true, BarnMode::Corrected) => None,
        };
        let length: f64 = path.windows(2).map(|pair| self.distance(pair[0], pair[1])).sum();
        let chord = self.distance(first, last);
        Some(BarnMetrics {
            closest_obstacle_cells,
            visibility_cells: visibility,
            dispersion,
            characteristic_dimension_cells: dimension,
            tortuosity: (chord > 0.0).then(|| length / chord),
        })
    }

    fn place(&self, cell: usize) -> (isize, isize) {
        (cell as isize / self.cols, cell as isize % self.cols)
    }

    /// Whether a cell is blocked; `None` outside the grid.
    fn is_blocked(&self, row: isize, col: isize) -> Option<bool> {
        let inside = row >= 0 && col >= 0 && row < self.rows && col < self.cols;
        inside.then(|| self.blocked[(row * self.cols + col) as usize])
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        let ((r, c), (s, d)) = (self.place(a), self.place(b));
        (((r - s) * (r - s) + (c - d) * (c - d)) as f64).sqrt()
    }

    /// Returns the visibility and the characteristic dimension of a cell.
    fn free_lengths(&self, cell: usize, mode: BarnMode) -> (f64, f64) {
        if self.blocked[cell] {
            return (0.0, -1.0);
        }
        let own = if mode == BarnMode::Reference { 2.0 } else { 0.0 };
        let (mut sum, mut least) = (0.0, (self.rows + self.cols) as f64);
        for ((down, right), runs) in AXES.into_iter().zip(&self.runs) {
            // Itself excluded.
            let free = runs[cell] - 1;
            let step = step_length(down, right);
            sum += (f64::from(free) + own) * step;
            least = least.min(f64::from(free) * step);
        }
        (sum / 8.0, least)
    }

    fn dispersion(&self, cell: usize, mode: BarnMode) -> f64 {
        if self.blocked[cell] {
            return -1.0;
        }
        let mut met = RAYS.map(|(down, right)| {
            let is_slope = match mode {
                BarnMode::Reference => down == 2 || right == 2,
                BarnMode::Corrected => down.abs() == 2 || right.abs() == 2,
            };
            let (mut row, mut col) = self.place(cell);
            let mut count = 0;
            while count < RADIUS {
                (row, col) = (row + down, col + right);
                match self.is_blocked(row, col) {
                    Some(true) => return true,
                    Some(false) => count += if is_slope { 2 } else { 1 },
                    None => return false,
                }
            }
            false
        });
        if mode == BarnMode::Reference {
            met.swap(SWAPPED.0, SWAPPED.1);
        }
        let changes = (0..RAYS.len()).filter(|&i| met[i] != met[(i + 1) % RAYS.len()]);
        changes.count() as f64
    }
}

/// Returns for each cell the length of the run of free cells along an axis that contains the cell. Two passes are
/// enough for all cells, whereas following the axis from each cell would take time proportional to the square of a
/// corridor's length.
fn runs(cols: usize, blocked: &[bool], (down, right): (isize, isize)) -> Vec<u32> {
    let step = down * cols as isize + right;
    // The cell before this one, or after it, along the axis.
    let beside = |cell: usize, back: bool| {
        let (step, right) = if back { (-step, -right) } else { (step, right) };
        let col = (cell % cols).checked_add_signed(right)?;
        let other = cell.checked_add_signed(step)?;
        (col < cols && other < blocked.len() && !blocked[other]).then_some(other)
    };
    let mut runs = vec![0; blocked.len()];
    for cell in (0..blocked.len()).filter(|&cell| !blocked[cell]) {
        runs[cell] = 1 + beside(cell, true).map_or(0, |other| runs[other]);
    }
    // The last cell of a run has its length.
    for cell in (0..blocked.len()).rev().filter(|&cell| !blocked[cell]) {
        if let Some(other) = beside(cell, false) {
            runs[cell] = runs[other];
        }
    }
    runs
}

fn step_length(down: isize, right: isize) -> f64 {
    if down != 0 && right != 0 { std::f64::consts::SQRT_2 } else { 1.0 }
}

features! {
    /// BARN's metrics ([`BarnMetrics`]) of the C-space grid, along the tour and along the shortest path from start
    /// to goal. In reference mode they are in cells, in corrected mode in metres. `None` if no goal can be reached,
    /// and if a metric does not exist.
    pub struct Barn {
        /// Along the tour, reference mode: distance to the closest obstacle.
        barn_reference_tour_closest_obstacle_cells: Option<f64>, "cells";
        /// Along the tour, reference mode: average visibility.
        barn_reference_tour_visibility_cells: Option<f64>, "cells";
        /// Along the tour, reference mode: dispersion.
        barn_reference_tour_dispersion: Option<f64>, "";
        /// Along the tour, reference mode: characteristic dimension.
        barn_reference_tour_characteristic_dimension_cells: Option<f64>, "cells";
        /// Along the tour, reference mode: tortuosity.
        barn_reference_tour_tortuosity: Option<f64>, "";
        /// Along the tour, corrected mode: distance to the closest obstacle.
        barn_tour_closest_obstacle_m: Option<f64>, "m";
        /// Along the tour, corrected mode: average visibility.
        barn_tour_visibility_m: Option<f64>, "m";
        /// Along the tour, corrected mode: dispersion.
        barn_tour_dispersion: Option<f64>, "";
        /// Along the tour, corrected mode: characteristic dimension.
        barn_tour_characteristic_dimension_m: Option<f64>, "m";
        /// Along the tour, corrected mode: tortuosity.
        barn_tour_tortuosity: Option<f64>, "";
        /// From start to goal, reference mode: distance to the closest obstacle.
        barn_reference_goal_closest_obstacle_cells: Option<f64>, "cells";
        /// From start to goal, reference mode: average visibility.
        barn_reference_goal_visibility_cells: Option<f64>, "cells";
        /// From start to goal, reference mode: dispersion.
        barn_reference_goal_dispersion: Option<f64>, "";
        /// From start to goal, reference mode: characteristic dimension.
        barn_reference_goal_characteristic_dimension_cells: Option<f64>, "cells";
        /// From start to goal, reference mode: tortuosity.
        barn_reference_goal_tortuosity: Option<f64>, "";
        /// From start to goal, corrected mode: distance to the closest obstacle.
        barn_goal_closest_obstacle_m: Option<f64>, "m";
        /// From start to goal, corrected mode: average visibility.
        barn_goal_visibility_m: Option<f64>, "m";
        /// From start to goal, corrected mode: dispersion.
        barn_goal_dispersion: Option<f64>, "";
        /// From start to goal, corrected mode: characteristic dimension.
        barn_goal_characteristic_dimension_m: Option<f64>, "m";
        /// From start to goal, corrected mode: tortuosity.
        barn_goal_tortuosity: Option<f64>, "";
    }
}

impl Barn {
    /// Computes the metrics of the cells of the tour and of those from start to goal, over cells of `side` metres.
    pub(super) fn of(
        cols: usize,
        blocked: &[bool],
        side: f64,
        tour: &[usize],
        to_goal: Option<&[usize]>,
    ) -> Self {
        let grid = Grid::new(cols, blocked);
        let metrics = |path: &[usize], mode| grid.metrics(path, mode);
        let tour = [BarnMode::Reference, BarnMode::Corrected].map(|mode| metrics(tour, mode));
        let goal = [BarnMode::Reference, BarnMode::Corrected]
            .map(|mode| to_goal.and_then(|path| metrics(path, mode)));
        let closest = |m: Option<BarnMetrics>| m.and_then(|m| m.closest_obstacle_cells);
        let visibility = |m: Option<BarnMetrics>| m.map(|m| m.visibility_cells);
        let dispersion = |m: Option<BarnMetrics>| m.map(|m| m.dispersion);
        let dimension = |m: Option<BarnMetrics>| m.map(|m| m.characteristic_dimension_cells);
        let tortuosity = |m: Option<BarnMetrics>| m.and_then(|m| m.tortuosity);
        let metres = |cells: Option<f64>| cells.map(|cells| cells * side);
        Barn {
            barn_reference_tour_closest_obstacle_cells: closest(tour[0]),
            barn_reference_tour_visibility_cells: visibility(tour[0]),
            barn_reference_tour_dispersion: dispersion(tour[0]),
            barn_reference_tour_characteristic_dimension_cells: dimension(tour[0]),
            barn_reference_tour_tortuosity: tortuosity(tour[0]),
            barn_tour_closest_obstacle_m: metres(closest(tour[1])),
            barn_tour_visibility_m: metres(visibility(tour[1])),
            barn_tour_dispersion: dispersion(tour[1]),
            barn_tour_characteristic_dimension_m: metres(dimension(tour[1])),
            barn_tour_tortuosity: tortuosity(tour[1]),
            barn_reference_goal_closest_obstacle_cells: closest(goal[0]),
            barn_reference_goal_visibility_cells: visibility(goal[0]),
            barn_reference_goal_dispersion: dispersion(goal[0]),
            barn_reference_goal_characteristic_dimension_cells: dimension(goal[0]),
            barn_reference_goal_tortuosity: tortuosity(goal[0]),
            barn_goal_closest_obstacle_m: metres(closest(goal[1])),
            barn_goal_visibility_m: metres(visibility(goal[1])),
            barn_goal_dispersion: dispersion(goal[1]),
            barn_goal_characteristic_dimension_m: metres(dimension(goal[1])),
            barn_goal_tortuosity: tortuosity(goal[1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Blocked cells from rows of text, in the order of the text, as BARN's files have them.
    fn map(rows: &[&str]) -> (usize, Vec<bool>) {
        (rows[0].len(), rows.iter().flat_map(|row| row.bytes().map(|cell| cell == b'#')).collect())
    }

    fn metrics(rows: &[&str], path: &[usize], mode: BarnMode) -> BarnMetrics {
        let (cols, blocked) = map(rows);
        BarnMetrics::of(cols, &blocked, path, mode).expect("a path")
    }

    const ROOM: [&str; 5] = ["#####", "#...#", "#...#", "#...#", "#####"];

    #[test]
    fn the_middle_of_a_room_by_hand() {
        let reference = metrics(&ROOM, &[12], BarnMode::Reference);
        // Two cells to the wall; rays of two free cells, of length 1 and root 2, the own one included.
        assert_eq!(reference.closest_obstacle_cells, Some(2.0));
        assert!((reference.visibility_cells - (1.0 + 2.0_f64.sqrt())).abs() < 1e-12);
        // Every ray meets the wall.
        assert_eq!(reference.dispersion, 0.0);
        assert_eq!(reference.characteristic_dimension_cells, 2.0);
        assert_eq!(reference.tortuosity, None);
        let corrected = metrics(&ROOM, &[12], BarnMode::Corrected);
        assert!((corrected.visibility_cells - (1.0 + 2.0_f64.sqrt()) / 2.0).abs() < 1e-12);
        let rest = BarnMetrics { visibility_cells: reference.visibility_cells, ..corrected };
        assert_eq!(rest, reference);
    }

    #[test]
    fn a_path_around_a_corner_by_hand() {
        let path = [6, 7, 13, 18];
        let found = metrics(&ROOM, &path, BarnMode::Reference);
        // A step of 1, one of root 2 and one of 1, between (1, 1) and (3, 3).
        let expected = (2.0 + 2.0_f64.sqrt()) / 8.0_f64.sqrt();
        assert!((found.tortuosity.expect("two ends") - expected).abs() < 1e-12);
        assert_eq!(found.closest_obstacle_cells, Some(1.0));
        // In the corners the other diagonal has no free cell, beside them the diagonals one each.
        let sides = 2.0_f64.sqrt();
        assert!((found.characteristic_dimension_cells - 2.0 * sides / 4.0).abs() < 1e-12);
    }

    #[test]
    fn one_obstacle_is_two_changes_of_the_dispersion() {
        let open = [".......", ".......", ".....#.", ".......", ".......", "......."];
        // The obstacle is on the ray to the right of the cell (2, 3), and on no other.
        for mode in [BarnMode::Reference, BarnMode::Corrected] {
            assert_eq!(metrics(&open, &[2 * 7 + 3], mode).dispersion, 2.0, "{mode:?}");
        }
    }

    #[test]
    fn rays_that_look_too_far_are_corrected() {
        // Three jumps up and left of the last cell: rows and columns of -6 and -3.
        let rows =
            ["....#...", "........", "........", "........", "........", "........", ".......@"];
        let (cols, blocked) = map(&rows);
        let path = [6 * 8 + 7];
        let dispersion = |mode| BarnMetrics::of(cols, &blocked, &path, mode).map(|m| m.dispersion);
        assert_eq!(dispersion(BarnMode::Reference), Some(2.0));
        assert_eq!(dispersion(BarnMode::Corrected), Some(0.0));
        // Mirrored, the same obstacle is too far for the published code too.
        let mirrored: Vec<bool> = blocked.iter().rev().copied().collect();
        let found =
            BarnMetrics::of(cols, &mirrored, &[0], BarnMode::Reference).map(|m| m.dispersion);
        assert_eq!(found, Some(0.0));
    }

    #[test]
    fn rays_in_the_wrong_order_are_corrected() {
        // One obstacle, two rows before the last cell and a column to its left.
        let rows = ["...#.", ".....", "....."];
        let (cols, blocked) = map(&rows);
        let dispersion = |mode| {
            BarnMetrics::of(cols, &blocked, &[2 * 5 + 4], mode).map(|metrics| metrics.dispersion)
        };
        assert_eq!(dispersion(BarnMode::Corrected), Some(2.0));
        assert_eq!(dispersion(BarnMode::Reference), Some(2.0));
        // The ray straight ahead is its neighbour, but the published code has two others between them.
        let rows = ["...##", ".....", "....."];
        let (cols, blocked) = map(&rows);
        let dispersion = |mode| {
            BarnMetrics::of(cols, &blocked, &[2 * 5 + 4], mode).map(|metrics| metrics.dispersion)
        };
        assert_eq!(dispersion(BarnMode::Corrected), Some(2.0));
        assert_eq!(dispersion(BarnMode::Reference), Some(4.0));
    }

    #[test]
    fn without_obstacles_the_reference_counts_half_the_rows() {
        let open = ["....", "....", "....", "...."];
        let found = metrics(&open, &[5, 6], BarnMode::Reference);
        assert_eq!((found.closest_obstacle_cells, found.dispersion), (Some(1.0), 0.0));
        assert_eq!(metrics(&open, &[5, 6], BarnMode::Corrected).closest_obstacle_cells, None);
        assert_eq!(BarnMetrics::of(4, &[false; 16], &[], BarnMode::Corrected), None);
    }

    proptest! {
        #[test]
        fn runs_are_those_of_walking(
            cells in prop::collection::vec(prop::bool::weighted(0.2), 60),
            cols in prop::sample::select(vec![1_usize, 2, 6, 10, 60]),
        ) {
            let rows = (60 / cols) as isize;
            for (down, right) in AXES {
                let found = runs(cols, &cells, (down, right));
                for cell in 0..60 {
                    let ahead = |down: isize, right: isize| {
                        let (row, col) = ((cell / cols) as isize, (cell % cols) as isize);
                        (1..)
                            .map(|k| (row + k * down, col + k * right))
                            .take_while(|&(r, c)| {
                                let inside = (0..rows).contains(&r) && (0..cols as isize).contains(&c);
                                inside && !cells[r as usize * cols + c as usize]
                            })
                            .count() as u32
                    };
                    let expected =
                        if cells[cell] { 0 } else { 1 + ahead(down, right) + ahead(-down, -right) };
                    prop_assert_eq!(found[cell], expected);
                }
            }
        }

        #[test]
        fn corrected_metrics_are_the_same_mirrored(
            cells in prop::collection::vec(prop::bool::weighted(0.2), 64),
            path in prop::collection::vec(0..64_usize, 1..9),
        ) {
            let found = BarnMetrics::of(8, &cells, &path, BarnMode::Corrected).expect("a path");
            let mirrored: Vec<bool> = cells.iter().rev().copied().collect();
            let back: Vec<usize> = path.iter().map(|cell| 63 - cell).collect();
            let other = BarnMetrics::of(8, &mirrored, &back, BarnMode::Corrected).expect("a path");
            prop_assert!((found.visibility_cells - other.visibility_cells).abs() < 1e-9);
            prop_assert_eq!(
                BarnMetrics { visibility_cells: 0.0, ..found },
                BarnMetrics { visibility_cells: 0.0, ..other }
            );
        }

        #[test]
        fn the_closest_obstacle_is_that_of_brute_force(
            cells in prop::collection::vec(prop::bool::weighted(0.1), 60),
            cell in 0..60_usize,
        ) {
            let found = BarnMetrics::of(10, &cells, &[cell], BarnMode::Corrected).expect("a path");
            let place = |cell: usize| ((cell / 10) as f64, (cell % 10) as f64);
            let (row, col) = place(cell);
            let blocked = (0..60).filter(|&other| cells[other]).map(place);
            let nearest = blocked.map(|(r, c)| ((r - row) * (r - row) + (c - col) * (c - col)).sqrt());
            prop_assert_eq!(found.closest_obstacle_cells, nearest.reduce(f64::min));
        }
    }
}
