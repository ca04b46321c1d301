//! Metrics of a block field.

use serde::Serialize;

use super::blueprint::BlockField;
use super::path::CheapestPaths;
use crate::difficulty::{BarnMetrics, BarnMode};

/// The metrics of a block field.
///
/// The last six describe the path from start to goal through the cells in which the robot's centre can be, which
/// keeps away from blocks. They are absent if no such path exists. Five of them are BARN's metrics, as its code
/// computes them ([`BarnMode::Reference`]).
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, cellular::CellularSpec};
///
/// let field = CellularSpec::default().generate(Seed(7))?;
/// let metrics = field.metrics();
/// let filled = field.cells().iter().filter(|filled| **filled).count() as f64;
/// assert!((metrics.filled - filled / field.cells().len() as f64).abs() < 1e-12);
/// assert!(metrics.tortuosity.is_some_and(|tortuosity| tortuosity >= 1.0));
/// # Ok::<(), envgen::cellular::CellularError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellularMetrics {
    /// Share of cells that were filled before smoothing, including those along closed sides.
    pub filled_before_smoothing: f64,
    /// Share of cells that are filled.
    pub filled: f64,
    /// Share of cells in which the robot's centre can be.
    pub free: f64,
    /// Number of fields that were drawn before this one and not accepted.
    pub rejected: u64,
    /// Length of the path in metres.
    pub path_length: Option<f64>,
    /// Mean distance to the closest blocked cell, in cells.
    pub closest_obstacle_cells: Option<f64>,
    /// Mean free length of the eight compass rays, in cells.
    pub visibility_cells: Option<f64>,
    /// Mean number of changes between free and blocked among 16 rays.
    pub dispersion: Option<f64>,
    /// Mean of the least free length along four axes, in cells.
    pub characteristic_dimension_cells: Option<f64>,
    /// Length of the path divided by the distance between its ends; absent also where both are the same cell.
    pub tortuosity: Option<f64>,
}

pub(super) fn measure(field: &BlockField) -> CellularMetrics {
    let (spec, cols) = (field.spec(), field.cols());
    let share = |count: usize| count as f64 / field.cells().len() as f64;
    let path = field.start.zip(field.goal).and_then(|(start, goal)| {
        let (start, goal) = (start as usize, goal as usize);
        CheapestPaths::new(cols, field.c_space(), spec.cell_size, start, Some(goal)).to(goal)
    });
    let barn = path
        .as_ref()
        .and_then(|path| BarnMetrics::of(cols, field.c_space(), path, BarnMode::Reference));
    CellularMetrics {
        filled_before_smoothing: share(field.drawn_filled() as usize),
        filled: share(field.cells().iter().filter(|filled| **filled).count()),
        free: share(field.c_space().iter().filter(|blocked| !**blocked).count()),
        rejected: field.rejected(),
        path_length: path.map(|path| spec.cell_size * length(cols, &path)),
        closest_obstacle_cells: barn.and_then(|barn| barn.closest_obstacle_cells),
        visibility_cells: barn.map(|barn| barn.visibility_cells),
        dispersion: barn.map(|barn| barn.dispersion),
        characteristic_dimension_cells: barn.map(|barn| barn.characteristic_dimension_cells),
        tortuosity: barn.and_then(|barn| barn.tortuosity),
    }
}

/// Returns the length of a path of neighbouring cells, in cells.
fn length(cols: usize, path: &[usize]) -> f64 {
    let is_diagonal =
        |pair: &&[usize]| pair[0] / cols != pair[1] / cols && pair[0] % cols != pair[1] % cols;
    let diagonals = path.windows(2).filter(is_diagonal).count();
    let straights = path.len() - 1 - diagonals;
    straights as f64 + diagonals as f64 * std::f64::consts::SQRT_2
}
