//! The settings of a landscape.

use serde::{Deserialize, Serialize};

use crate::error::SpecError;
use crate::settings::Setting;
use crate::world::MAX_COORDINATE;

/// The most cells a landscape can have: 8192 x 8192, which take 128 MiB.
pub const MAX_CELLS: u64 = 1 << 26;

/// The most cells a smoothed landscape can have: 4096 x 4096. Smoothing takes 28 bytes per cell.
pub const MAX_SMOOTH_CELLS: u64 = 1 << 24;

/// The most swaps that mixing tries: about a minute.
const MAX_SWAPS: f64 = 1e9;

/// The swaps that mixing tries by default, for landscapes of 40,000 to 5,000,000 cells.
const DEFAULT_SWAPS: f64 = 4e7;

/// The fewest and most of them per cell, for larger and for smaller landscapes.
const DEFAULT_MIXING: [f64; 2] = [8.0, 1000.0];

/// A landscape to generate.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, landscape::LandscapeSpec};
///
/// let spec = LandscapeSpec { classes: 10, total_edge: Some(2376), ..Default::default() };
/// let landscape = spec.generate(Seed(7))?;
/// assert_eq!(landscape.total_edge(), 2376);
/// assert!((landscape.entropy() - 1.9).abs() < 1e-5);
/// # Ok::<(), envgen::landscape::LandscapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LandscapeSpec {
    /// Number of rows.
    pub rows: u64,
    /// Number of columns.
    pub cols: u64,
    /// Number of classes.
    pub classes: u64,
    /// Entropy of the classes' shares in nats.
    pub entropy: f64,
    /// Whether every class has a cell.
    pub keep_classes: bool,
    /// Which class gets which number of cells.
    pub order: ClassOrder,
    /// How the classes are arranged.
    pub algorithm: Algorithm,
    /// Probability of an extra change of class in the automaton; `None` is the one that the Total Edge
    /// needs, or 0.1 where none is requested.
    pub epsilon: Option<f64>,
    /// Standard deviation of the smoothing in cells; `None` is the one that the Total Edge needs,
    /// or 3 where none is requested.
    pub sigma: Option<f64>,
    /// Total Edge to reach exactly, in cell sides; `None` accepts what the arrangement gives.
    pub total_edge: Option<u64>,
    /// Swaps tried per cell at the requested Total Edge, so that a mixed landscape does not depend on how
    /// it was built; `None` is 1000, fewer for landscapes of more than 40,000 cells, and at least 8.
    pub mixing: Option<f64>,
    /// Side of a cell in metres.
    pub cell: f64,
    /// Factor on a robot's greatest speed for each class, 0 where it cannot pass; empty is 1 for
    /// all.
    pub speeds: Vec<f64>,
}

impl Default for LandscapeSpec {
    fn default() -> Self {
        LandscapeSpec {
            rows: 48,
            cols: 48,
            classes: 9,
            entropy: 1.9,
            keep_classes: false,
            order: ClassOrder::Shuffled,
            algorithm: Algorithm::Random,
            epsilon: None,
            sigma: None,
            total_edge: None,
            mixing: None,
            cell: 1.0,
            speeds: Vec::new(),
        }
    }
}

/// Which class gets which number of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClassOrder {
    /// Drawn at random.
    Shuffled,
    /// Class 1 has the most cells, class 2 the second most, and so on.
    Descending,
}

/// How a landscape's cells are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Algorithm {
    /// The paper's algorithm 1, uniformly random; with a Total Edge the same as `Mixed`.
    Random,
    /// The paper's algorithm 2, the probabilistic automaton, repaired to the Total Edge.
    Automaton,
    /// Salt and pepper: from bands or a checkerboard by random swaps.
    Mixed,
    /// Bands, repeated as often as the Total Edge needs.
    Bands,
    /// Natural patches: smoothed noise, divided by the counts.
    Smooth,
}

impl Algorithm {
    /// The name, as in the settings.
    pub fn name(self) -> &'static str {
        match self {
            Algorithm::Random => "random",
            Algorithm::Automaton => "automaton",
            Algorithm::Mixed => "mixed",
            Algorithm::Bands => "bands",
            Algorithm::Smooth => "smooth",
        }
    }
}

const ROWS: Setting = Setting::integer("rows", 1, MAX_CELLS, "number of rows");
const COLS: Setting = Setting::integer("cols", 1, MAX_CELLS, "number of columns");
pub(super) const CLASSES: Setting = Setting::integer("classes", 1, 65_535, "number of classes");
pub(super) const ENTROPY: Setting =
    Setting::number("entropy", "nats", 0.0, 12.0, "Shannon entropy of the classes' shares");
const KEEP_CLASSES: Setting = Setting::flag("keep_classes", "whether every class has a cell");
const ORDER: Setting =
    Setting::choice("order", &["shuffled", "descending"], "which class gets which number of cells");
const ALGORITHM: Setting = Setting::choice(
    "algorithm",
    &["random", "automaton", "mixed", "bands", "smooth"],
    "how the cells are arranged",
);
const EPSILON: Setting = Setting::number(
    "epsilon",
    "",
    0.0,
    1.0,
    "probability of an extra change of class in the automaton (absent: as total_edge needs, \
     or 0.1)",
);
const SIGMA: Setting = Setting::number(
    "sigma",
    "cells",
    0.0,
    1e6,
    "standard deviation of the smoothing (absent: as total_edge needs, or 3)",
);
pub(super) const TOTAL_EDGE: Setting = Setting::integer(
    "total_edge",
    0,
    2 * MAX_CELLS,
    "number of sides between cells of different class to reach exactly (absent: any)",
);
const MIXING: Setting = Setting::number(
    "mixing",
    "1/cell",
    0.0,
    1000.0,
    "swaps tried per cell at total_edge (absent: 1000, fewer for over 40,000 cells, at least 8)",
);
const CELL: Setting = Setting::number("cell", "m", 1e-3, 1e4, "side of a cell");
const SPEEDS: Setting = Setting::list(
    "speeds",
    "",
    "numbers from 0 to 10, one per class",
    "factor on a robot's greatest speed for each class, 0 where it cannot pass (empty: 1)",
)
.such_as("1,0.5,0");

pub(super) const SETTINGS: &[Setting] = &[
    ROWS,
    COLS,
    CLASSES,
    ENTROPY,
    KEEP_CLASSES,
    ORDER,
    ALGORITHM,
    EPSILON,
    SIGMA,
    TOTAL_EDGE,
    MIXING,
    CELL,
    SPEEDS,
];

pub(super) const RULES: &[&str] = &[
    "`rows` times `cols` is at most 67,108,864, and 16,777,216 where `algorithm` is smooth",
    "`mixing` times `rows` times `cols` is at most 1,000,000,000 swaps",
    "`speeds` is empty or has one number for each of the `classes`",
    "`classes` is at most `rows` times `cols`",
    "`entropy` is at most what that many `classes` reach, and where `keep_classes` is true at least \
     what they have with one cell each but for one class",
    "`total_edge` lies between bounds that follow from `rows`, `cols`, `classes` and `entropy`, which \
     an error names",
];

impl LandscapeSpec {
    /// Number of cells.
    pub(super) fn cells(&self) -> f64 {
        self.rows as f64 * self.cols as f64
    }

    /// Swaps tried per cell.
    pub(super) fn swaps_per_cell(&self) -> f64 {
        let [least, most] = DEFAULT_MIXING;
        self.mixing.unwrap_or_else(|| (DEFAULT_SWAPS / self.cells()).clamp(least, most))
    }

    /// Checks the fields and sizes that need no composition.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        ROWS.check_integer(self.rows)?;
        COLS.check_integer(self.cols)?;
        let cells = self.rows * self.cols;
        let limit = if self.algorithm == Algorithm::Smooth { MAX_SMOOTH_CELLS } else { MAX_CELLS };
        if cells > limit {
            let allowed =
                format!("at most {limit} cells with the algorithm `{}`", self.algorithm.name());
            return Err(SpecError::new("rows * cols", cells, allowed));
        }
        if let Some(epsilon) = self.epsilon {
            EPSILON.check(epsilon)?;
        }
        if let Some(sigma) = self.sigma {
            SIGMA.check(sigma)?;
        }
        if let Some(mixing) = self.mixing {
            MIXING.check(mixing)?;
            let most = MAX_SWAPS / cells as f64;
            if mixing > most {
                let allowed = format!("at most {most} for {cells} cells");
                return Err(MIXING.error_with(mixing, allowed));
            }
        }
        CELL.check(self.cell)?;
        let longest = self.rows.max(self.cols);
        if self.cell * longest as f64 > MAX_COORDINATE {
            let allowed = format!(
                "at most {} m for {longest} cells in a row: worlds end at {MAX_COORDINATE} m",
                MAX_COORDINATE / longest as f64
            );
            return Err(CELL.error_with(self.cell, allowed));
        }
        if let Some(&speed) = self.speeds.iter().find(|speed| !(0.0..=10.0).contains(*speed)) {
            return Err(SPEEDS.error(speed));
        }
        if !self.speeds.is_empty() && self.speeds.len() as u64 != self.classes {
            let allowed = format!("empty, or as many as the {} classes", self.classes);
            let given = format!("a list of {}", self.speeds.len());
            return Err(SpecError::new(SPEEDS.name, given, allowed));
        }
        Ok(())
    }
}
