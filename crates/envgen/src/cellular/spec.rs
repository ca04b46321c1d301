//! The settings of a block field.

use serde::{Deserialize, Serialize};
use strum::VariantNames;

use crate::error::SpecError;
use crate::settings;

/// The greatest number of cells that the attempts of one world may visit, over all passes; it takes some seconds.
pub const MAX_VISITS: u64 = 1 << 30;

settings! {
    /// The settings of a block field. The defaults are those of BARN's first world; BARN's data set has `fill`
    /// 0.15, 0.20, 0.25 and 0.30 with 2, 3 and 4 passes of smoothing.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, cellular::CellularSpec};
    ///
    /// let spec = CellularSpec { fill: 0.25, smoothing: 3, ..Default::default() };
    /// let field = spec.generate(Seed(7))?;
    /// let world = field.to_world();
    /// assert!(world.start.is_some() && world.goal.is_some());
    /// # Ok::<(), envgen::cellular::CellularError>(())
    /// ```
    pub struct CellularSpec {
        /// Number of rows, filled ones along closed sides included.
        rows: u64 = 30 => integer("", 1..=1024);
        /// Number of columns, filled ones along closed sides included.
        cols: u64 = 30 => integer("", 1..=1024);
        /// Side of a cell.
        cell_size: f64 = 0.15 => number("m", 0.001..=1000.0);
        /// Probability that a cell is filled before smoothing.
        fill: f64 = 0.2 => number("", 0.0..=1.0);
        /// Number of smoothing passes.
        smoothing: u64 = 4 => integer("", 0..=100);
        /// Smoothing fills a cell that has at least this many filled neighbours, of eight.
        #[group = "rules"]
        fill_from: u64 = 5 => integer("", 1..=9);
        /// Smoothing clears a cell that has at most this many filled neighbours, of eight.
        clear_to: u64 = 1 => integer("", 0..=8);
        /// Sides of the field that are open; the others are filled.
        open_sides: OpenSides = OpenSides::LeftRight => choice;
        /// A robot's middle can be in a cell if this many cells on each side of it are free as well.
        #[group = "acceptance"]
        robot_cells: u64 = 2 => integer("", 0..=100);
        /// Which fields are accepted.
        acceptance: Acceptance = Acceptance::LargestRegions => choice;
        /// Fields that are drawn at most until one is accepted. Where `fill` is 0.3, about one of 400 is.
        attempts: u64 = 100_000 => integer("", 1..=1_000_000);
        /// Where start and goal are, at the left and at the right side of the field.
        ends: Ends = Ends::Random => choice;
    }
}

/// The sides of a field that are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum OpenSides {
    /// No side: the outermost cells are all filled.
    None,
    /// The left and the right side, as in BARN; the first and the last row are filled.
    LeftRight,
    /// All four sides.
    All,
}

impl OpenSides {
    /// Whether the first and the last row are filled.
    pub(super) fn closes_rows(self) -> bool {
        self != OpenSides::All
    }

    /// Whether the first and the last column are filled.
    pub(super) fn closes_cols(self) -> bool {
        self == OpenSides::None
    }
}

/// Which fields are accepted. Regions consist of the cells in which a robot's centre can be, joined by their sides.
/// A region reaches a side of the field if it contains one of the cells that are nearest to that side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Acceptance {
    /// As in BARN: the largest of the regions that reach the left side is also the largest of those that reach the
    /// right side.
    LargestRegions,
    /// Some region reaches both sides.
    Crossing,
    /// All fields.
    All,
}

/// Where start and goal are: among the cells nearest to the left and to the right side, in the largest region that
/// reaches the side; or, if fields are accepted that have any crossing, in the largest region that crosses the
/// field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Ends {
    /// In any of these cells at random, as in BARN.
    Random,
    /// In the cell that is nearest to the middle of the side; of two such cells, in the upper one.
    Middle,
}

pub(super) const RULES: &[&str] = &[
    "`clear_to` is less than `fill_from`",
    "`rows` is at least 3 + 2 `robot_cells`, unless `open_sides` is all",
    "`cols` is at least 3 + 2 `robot_cells` where `open_sides` is none",
    "`rows` times `cols` times `attempts` times (2 + `smoothing`) is at most 1,073,741,824",
];

impl CellularSpec {
    /// Checks every field, and the rules about several fields.
    pub(super) fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        if self.clear_to >= self.fill_from {
            let allowed = format!("less than fill_from, which is {}", self.fill_from);
            return Err(SpecError::new("clear_to", self.clear_to, allowed));
        }
        let least = 3 + 2 * self.robot_cells;
        let sides = [
            ("rows", self.rows, self.open_sides.closes_rows()),
            ("cols", self.cols, self.open_sides.closes_cols()),
        ];
        for (field, value, is_closed) in sides {
            if is_closed && value < least {
                let allowed = format!(
                    "at least {least}: the outermost cells are filled, and the robot needs {} free ones \
                     on each side",
                    self.robot_cells
                );
                return Err(SpecError::new(field, value, allowed));
            }
        }
        let visits = self.cells() * (2 + self.smoothing);
        if visits * self.attempts > MAX_VISITS {
            let allowed = format!(
                "at most {} for {} cells and {} passes",
                MAX_VISITS / visits,
                self.cells(),
                self.smoothing
            );
            return Err(SpecError::new("attempts", self.attempts, allowed));
        }
        Ok(())
    }

    /// Returns the number of cells.
    pub(super) fn cells(&self) -> u64 {
        self.rows * self.cols
    }

    /// Returns the columns of the cells nearest to the left and to the right side that can be free.
    pub(super) fn end_columns(&self) -> [usize; 2] {
        let inset = if self.open_sides.closes_cols() { 1 + self.robot_cells } else { 0 };
        [inset as usize, (self.cols - 1 - inset) as usize]
    }
}
