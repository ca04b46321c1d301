//! The blueprint of a block field: the field that is generated from a spec.

use serde::{Serialize, Serializer};

use super::spec::CellularSpec;
use crate::seed::Seed;

/// A field of filled and free cells, with the spec and seed from which it was generated. Cells are listed row by
/// row from the top, each row from the left.
///
/// ```
/// use envgen::{Seed, Spec, cellular::CellularSpec};
///
/// let field = CellularSpec { rows: 20, cols: 40, ..Default::default() }.generate(Seed(7))?;
/// assert_eq!(field.cells().len(), field.rows() * field.cols());
/// // The start is a row, from the top, and a column; the robot's middle can be there.
/// let [row, col] = field.start().expect("an accepted field has a start");
/// assert!(!field.c_space()[row as usize * field.cols() + col as usize]);
/// # Ok::<(), envgen::cellular::CellularError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BlockField {
    pub(super) cells: Vec<bool>,
    pub(super) blocked: Vec<bool>,
    pub(super) start: Option<u32>,
    pub(super) goal: Option<u32>,
    /// Whether the goal can be reached from the start.
    pub(super) is_crossed: bool,
    pub(super) drawn_filled: u64,
    pub(super) rejected: u64,
    pub(super) spec: CellularSpec,
    pub(super) seed: Seed,
}

impl BlockField {
    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.spec.rows as usize
    }

    /// Returns the number of columns.
    pub fn cols(&self) -> usize {
        self.spec.cols as usize
    }

    /// Returns for each cell whether it is filled.
    pub fn cells(&self) -> &[bool] {
        &self.cells
    }

    /// Returns for each cell whether the robot's centre cannot be in it.
    pub fn c_space(&self) -> &[bool] {
        &self.blocked
    }

    /// Returns the cell in which the robot starts, as row and column; `None` if no cell at the left side is free.
    pub fn start(&self) -> Option<[u32; 2]> {
        self.start.map(|cell| self.place(cell))
    }

    /// Returns the cell that the robot should reach, as row and column; `None` if no cell at the right side is free.
    pub fn goal(&self) -> Option<[u32; 2]> {
        self.goal.map(|cell| self.place(cell))
    }

    /// Returns the number of cells that were filled before smoothing.
    pub fn drawn_filled(&self) -> u64 {
        self.drawn_filled
    }

    /// Returns the number of fields that were drawn before this one and not accepted.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Returns the spec.
    pub fn spec(&self) -> &CellularSpec {
        &self.spec
    }

    /// Returns the seed with which the field was drawn.
    pub fn seed(&self) -> Seed {
        self.seed
    }

    fn place(&self, cell: u32) -> [u32; 2] {
        [cell / self.spec.cols as u32, cell % self.spec.cols as u32]
    }
}

impl Serialize for BlockField {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields {
            rows: u64,
            cols: u64,
            cell: f64,
            start: Option<[u32; 2]>,
            goal: Option<[u32; 2]>,
            cells: Vec<String>,
        }
        let text =
            |row: &[bool]| row.iter().map(|&filled| if filled { '#' } else { '.' }).collect();
        Fields {
            rows: self.spec.rows,
            cols: self.spec.cols,
            cell: self.spec.cell_size,
            start: self.start(),
            goal: self.goal(),
            cells: self.cells.chunks_exact(self.cols()).map(text).collect(),
        }
        .serialize(serializer)
    }
}
