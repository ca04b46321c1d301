//! The settings of a landscape.

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use crate::error::SpecError;
use crate::settings;
use crate::world::{MAX_COORDINATE, ROCK};

/// The greatest number of cells of a landscape: 8192 x 8192, which take 128 MiB.
pub const MAX_CELLS: u64 = 1 << 26;

/// The greatest number of cells of a smoothed landscape: 4096 x 4096. Smoothing takes 28 bytes per cell.
pub const MAX_SMOOTH_CELLS: u64 = 1 << 24;

/// The greatest number of swaps that mixing tries, which take about a minute.
const MAX_SWAPS: f64 = 1e9;

/// The default number of swaps that mixing tries, for landscapes of 40,000 to 5,000,000 cells.
const DEFAULT_SWAPS: f64 = 4e7;

/// The least and the greatest default number of swaps per cell, for larger and for smaller landscapes.
const DEFAULT_MIXING: [f64; 2] = [8.0, 1000.0];

/// Whether the height is the default, which files omit, so that the files of other landscapes are the same as
/// before the setting existed.
fn is_rock_height(value: &f64) -> bool {
    *value == ROCK.top()
}

settings! {
    /// The settings of a landscape.
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
    pub struct LandscapeSpec {
        /// Number of rows.
        rows: u64 = 48 => integer("", 1..=MAX_CELLS);
        /// Number of columns.
        cols: u64 = 48 => integer("", 1..=MAX_CELLS);
        /// Number of classes.
        classes: u64 = 9 => integer("", 1..=65_535);
        /// Shannon entropy of the classes' shares.
        entropy: f64 = 1.9 => number("nats", 0.0..=12.0);
        /// Whether every class has a cell.
        #[group = "arrangement"]
        keep_classes: bool = false => flag;
        /// Which class gets which number of cells.
        order: ClassOrder = ClassOrder::Shuffled => choice;
        /// How the classes are arranged.
        #[group = ""]
        algorithm: Algorithm = Algorithm::Random => choice;
        /// Probability of an extra change of class in the automaton; none: the one that the Total Edge
        /// needs, or 0.1 where none is requested.
        #[group = "arrangement"]
        epsilon: Option<f64> = None => optional_number("", 0.0..=1.0);
        /// Standard deviation of the smoothing; none: the one that the Total Edge needs, or 3 where none is
        /// requested.
        sigma: Option<f64> = None => optional_number("cells", 0.0..=1e6);
        /// Total Edge to reach exactly, the number of sides between cells of different class; none accepts
        /// what the arrangement gives.
        #[group = ""]
        total_edge: Option<u64> = None => optional_integer("", 0..=2 * MAX_CELLS);
        /// Swaps tried per cell at the requested Total Edge, so that a mixed landscape does not depend on
        /// how it was built; none: 1000, fewer for landscapes of more than 40,000 cells, and at least 8.
        #[group = "arrangement"]
        mixing: Option<f64> = None => optional_number("1/cell", 0.0..=1000.0);
        /// Side of a cell.
        #[alias = "cell"]
        #[group = "cells"]
        cell_size: f64 = 1.0 => number("m", 1e-3..=1e4);
        /// Factor on a robot's greatest speed for each class, 0 where it cannot pass; empty: 1 for all.
        speeds: Vec<f64> = Vec::new() => list("", "numbers from 0 to 10, one per class", "1,0.5,0");
        /// Height of the obstacles where robots cannot pass.
        #[serde(skip_serializing_if = "is_rock_height")]
        rock_height: f64 = ROCK.top() => number("m", 0.01..=100.0);
    }
}

/// Which class gets which of the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum ClassOrder {
    /// The order is drawn at random.
    Shuffled,
    /// Class 1 has the most cells, class 2 the second most, and so on.
    Descending,
}

/// The algorithm that arranges a landscape's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Algorithm {
    /// The paper's algorithm 1, uniformly random. With a requested Total Edge it is the same as `Mixed`.
    Random,
    /// The paper's algorithm 2, the probabilistic automaton, repaired to the Total Edge.
    Automaton,
    /// Salt-and-pepper landscapes: random swaps, starting from bands or a checkerboard.
    Mixed,
    /// Bands, repeated as often as the Total Edge requires.
    Bands,
    /// Natural patches: smoothed noise, divided into classes by the counts.
    Smooth,
}

impl Algorithm {
    /// Returns the name of the algorithm, as in the settings.
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

/// The greatest standard deviation of the smoothing, per cell of the longer side.
const MOST_SMOOTHING: f64 = 4.0;

pub(super) const RULES: &[&str] = &[
    "`rows` times `cols` is at most 67,108,864, and 16,777,216 where `algorithm` is smooth",
    "`mixing` times `rows` times `cols` is at most 1,000,000,000 swaps",
    "`sigma` is at most 4 times the greater of `rows` and `cols`, where `algorithm` is smooth",
    "the greater of `rows` and `cols` times `cell_size` is at most 100,000 km",
    "`speeds` is empty or has one number for each of the `classes`",
    "`classes` is at most `rows` times `cols`",
    "`entropy` is at most what that many `classes` reach, and where `keep_classes` is true at least \
     what they have with one cell each but for one class",
    "`total_edge` lies between bounds that follow from `rows`, `cols`, `classes` and `entropy`, which \
     an error names; where `algorithm` is automaton or smooth, they are narrower and depend on the seed",
];

impl LandscapeSpec {
    /// Returns the number of cells.
    pub(super) fn cells(&self) -> f64 {
        self.rows as f64 * self.cols as f64
    }

    /// Returns the number of swaps that are tried per cell.
    pub(super) fn swaps_per_cell(&self) -> f64 {
        let [least, most] = DEFAULT_MIXING;
        self.mixing.unwrap_or_else(|| (DEFAULT_SWAPS / self.cells()).clamp(least, most))
    }

    /// Checks the fields and sizes that do not depend on the composition.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let cells = self.rows * self.cols;
        let limit = if self.algorithm == Algorithm::Smooth { MAX_SMOOTH_CELLS } else { MAX_CELLS };
        if cells > limit {
            let allowed =
                format!("at most {limit} cells with the algorithm `{}`", self.algorithm.name());
            return Err(SpecError::new("rows * cols", cells, allowed));
        }
        if let Some(mixing) = self.mixing {
            let most = MAX_SWAPS / cells as f64;
            if mixing > most {
                let allowed = format!("at most {most} for {cells} cells");
                return Err(SpecError::new("mixing", mixing, allowed));
            }
        }
        let longest = self.rows.max(self.cols);
        if let Some(sigma) = self.sigma.filter(|_| self.algorithm == Algorithm::Smooth) {
            // What is smoothed more is one value in single precision.
            let most = MOST_SMOOTHING * longest as f64;
            if sigma > most {
                let allowed = format!("at most {most} cells for {longest} cells in a row");
                return Err(SpecError::new("sigma", sigma, allowed));
            }
        }
        if self.cell_size * longest as f64 > MAX_COORDINATE {
            let allowed = format!(
                "at most {} m for {longest} cells in a row: worlds end at {MAX_COORDINATE} m",
                MAX_COORDINATE / longest as f64
            );
            return Err(SpecError::new("cell_size", self.cell_size, allowed));
        }
        if let Some(&speed) = self.speeds.iter().find(|speed| !(0.0..=10.0).contains(*speed)) {
            return Err(const { Self::setting("speeds") }.error(speed));
        }
        if !self.speeds.is_empty() && self.speeds.len() as u64 != self.classes {
            let allowed = format!("empty, or as many as the {} classes", self.classes);
            let given = format!("a list of {}", self.speeds.len());
            return Err(SpecError::new("speeds", given, allowed));
        }
        Ok(())
    }
}
