//! Generates a block field from a spec and a seed.

use super::blueprint::BlockField;
use super::c_space::{c_space, regions};
use super::error::CellularError;
use super::spec::{Acceptance, CellularSpec, Ends};
use crate::seed::{Seed, Stream};

/// Generates the block field of a valid spec.
pub(super) fn field(spec: &CellularSpec, seed: Seed) -> Result<BlockField, CellularError> {
    for attempt in 0..spec.attempts {
        let drawn = random_fill(spec, &mut seed.attempt("cellular/fill", 0, attempt));
        let drawn_filled = drawn.iter().filter(|filled| **filled).count() as u64;
        let mut cells = drawn;
        for _ in 0..spec.smoothing {
            let next = smoothed(spec, &cells);
            // Further passes would change nothing either.
            if next == cells {
                break;
            }
            cells = next;
        }
        let blocked = c_space(spec.cols as usize, &cells, spec.robot_cells as usize);
        if let Some(Sides { is_crossed, cells: sides }) = accepted(spec, &blocked) {
            let mut stream = seed.stream("cellular/ends", 0);
            let [start, goal] = sides.map(|cells| end(spec, &cells, &mut stream));
            let (spec, rejected) = (spec.clone(), attempt);
            return Ok(BlockField {
                cells,
                blocked,
                start,
                goal,
                is_crossed,
                drawn_filled,
                rejected,
                spec,
                seed,
            });
        }
    }
    Err(CellularError::Attempts { attempts: spec.attempts })
}

/// Fills the cells along closed sides, and each other cell at random.
fn random_fill(spec: &CellularSpec, stream: &mut Stream) -> Vec<bool> {
    let (rows, cols, sides) = (spec.rows, spec.cols, spec.open_sides);
    let mut cells = Vec::with_capacity(spec.cells() as usize);
    for row in 0..rows {
        let is_end_row = sides.closes_rows() && (row == 0 || row == rows - 1);
        for col in 0..cols {
            let is_end = is_end_row || sides.closes_cols() && (col == 0 || col == cols - 1);
            cells.push(is_end || stream.chance(spec.fill));
        }
    }
    cells
}

/// Makes one pass of smoothing, in which every cell depends on the neighbours that it had before the pass. All
/// cells beyond closed sides count as filled, all cells beyond open sides as free. A cell beyond a corner counts
/// like the row above or below the field.
fn smoothed(spec: &CellularSpec, cells: &[bool]) -> Vec<bool> {
    let (rows, cols) = (spec.rows as isize, spec.cols as isize);
    let is_filled = |row: isize, col: isize| {
        if row < 0 || row >= rows {
            return spec.open_sides.closes_rows();
        }
        if col < 0 || col >= cols {
            return spec.open_sides.closes_cols();
        }
        cells[(row * cols + col) as usize]
    };
    let mut next = Vec::with_capacity(cells.len());
    for row in 0..rows {
        // Filled cells in the column of three rows around each cell.
        let column =
            |col: isize| (row - 1..=row + 1).map(|row| u64::from(is_filled(row, col))).sum::<u64>();
        let (mut left, mut middle) = (column(-1), column(0));
        for col in 0..cols {
            let right = column(col + 1);
            let own = cells[(row * cols + col) as usize];
            let neighbours = left + middle + right - u64::from(own);
            next.push(if neighbours >= spec.fill_from {
                true
            } else if neighbours <= spec.clear_to {
                false
            } else {
                own
            });
            (left, middle) = (middle, right);
        }
    }
    next
}

/// The left and the right side of an accepted field.
struct Sides {
    /// Whether a robot can go from one side to the other.
    is_crossed: bool,
    /// The cells at each side in which start and goal can be, from the top.
    cells: [Vec<u32>; 2],
}

fn accepted(spec: &CellularSpec, blocked: &[bool]) -> Option<Sides> {
    let cols = spec.cols as usize;
    let (numbers, sizes) = regions(cols, blocked);
    let at_side = |col: usize| (0..spec.rows as usize).map(move |row| row * cols + col);
    let [left, right] = spec.end_columns();
    let size = |number: u32| sizes[number as usize - 1];
    // Of equal regions the one that is found first from the top.
    let largest = |col: usize, among: &dyn Fn(u32) -> bool| {
        let at_side =
            at_side(col).map(|cell| numbers[cell]).filter(|&number| number > 0 && among(number));
        at_side.reduce(|best, number| if size(number) > size(best) { number } else { best })
    };
    let [at_left, at_right] = match spec.acceptance {
        Acceptance::LargestRegions | Acceptance::All => {
            [left, right].map(|col| largest(col, &|_| true))
        }
        Acceptance::Crossing => {
            let mut crosses = vec![false; sizes.len() + 1];
            at_side(right).for_each(|cell| crosses[numbers[cell] as usize] = true);
            [largest(left, &|number| crosses[number as usize]); 2]
        }
    };
    let is_crossed = at_left.is_some() && at_left == at_right;
    let cells = |col: usize, region: Option<u32>| {
        let of_region = |cell: &usize| region == Some(numbers[*cell]);
        at_side(col).filter(of_region).map(|cell| cell as u32).collect()
    };
    let is_accepted = is_crossed || spec.acceptance == Acceptance::All;
    is_accepted.then(|| Sides { is_crossed, cells: [cells(left, at_left), cells(right, at_right)] })
}

/// Returns one of the cells of a side, which are listed from the top; `None` if the side has no such cell.
fn end(spec: &CellularSpec, cells: &[u32], stream: &mut Stream) -> Option<u32> {
    match spec.ends {
        Ends::Random if cells.is_empty() => None,
        Ends::Random => Some(cells[stream.below(cells.len() as u64) as usize]),
        Ends::Middle => {
            let from_middle = |&&cell: &&u32| {
                let row = u64::from(cell) / spec.cols;
                (2 * row + 1).abs_diff(spec.rows)
            };
            cells.iter().min_by_key(from_middle).copied()
        }
    }
}

/// Returns the cells that are nearest to the middle of the first and of the last column of a grid with these
/// blocked cells, in the largest regions that reach these columns.
#[cfg(feature = "barn")]
pub(crate) fn middle_ends(cols: usize, blocked: &[bool], robot_cells: usize) -> [Option<usize>; 2] {
    let spec = CellularSpec {
        rows: (blocked.len() / cols) as u64,
        cols: cols as u64,
        robot_cells: robot_cells as u64,
        acceptance: Acceptance::All,
        ends: Ends::Middle,
        ..Default::default()
    };
    let sides = accepted(&spec, blocked).map_or_else(Default::default, |sides| sides.cells);
    // Nothing is drawn for the middle.
    let mut stream = Seed(0).stream("cellular/ends", 0);
    sides.map(|cells| end(&spec, &cells, &mut stream).map(|cell| cell as usize))
}
