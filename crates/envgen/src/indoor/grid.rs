//! The grid of a plan: cells, the sides of rooms, and openings in the walls between cells.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The content of a cell of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cell {
    /// Solid ground that is not part of any room, hallway or open area.
    #[default]
    Solid,
    /// A piece of a hallway.
    Hallway,
    /// A piece of an open area: floor between the rooms, without walls of its own.
    Open,
    /// Part of the room with this index.
    Room(u32),
}

impl Cell {
    /// Returns whether the cell is a hallway or an open area. No walls divide these.
    #[inline]
    pub fn is_floor(self) -> bool {
        matches!(self, Cell::Hallway | Cell::Open)
    }

    /// Returns the character that represents the cell in a blueprint.
    pub fn symbol(self) -> char {
        match self {
            Cell::Solid => '#',
            Cell::Hallway => '.',
            Cell::Open => 'o',
            Cell::Room(_) => 'r',
        }
    }
}

/// A rectangular grid of cells, with columns from left to right and rows from top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    width: u32,
    height: u32,
    cells: Vec<Cell>,
}

impl Grid {
    /// Creates a grid of solid cells.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let cells = vec![Cell::Solid; width as usize * height as usize];
        Grid { width, height, cells }
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the cell in column `x` and row `y`; `None` outside the grid.
    #[inline]
    pub fn get(&self, x: u32, y: u32) -> Option<Cell> {
        (x < self.width && y < self.height).then(|| self.cells[self.index(x, y)])
    }

    /// Returns all cells, row by row from the top.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Returns the number of cells that satisfy a condition.
    pub fn count(&self, condition: impl Fn(Cell) -> bool) -> usize {
        self.cells.iter().filter(|&&cell| condition(cell)).count()
    }

    /// Returns the index of a cell in [`Grid::cells`]. The cell must lie in the grid.
    #[inline]
    pub(super) fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// Returns the position of the cell with an index in [`Grid::cells`].
    #[inline]
    pub(super) fn position(&self, index: usize) -> (u32, u32) {
        ((index % self.width as usize) as u32, (index / self.width as usize) as u32)
    }

    #[inline]
    pub(super) fn at(&self, x: u32, y: u32) -> Cell {
        self.cells[self.index(x, y)]
    }

    #[inline]
    pub(super) fn set(&mut self, x: u32, y: u32, cell: Cell) {
        let index = self.index(x, y);
        self.cells[index] = cell;
    }

    pub(super) fn set_index(&mut self, index: usize, cell: Cell) -> Cell {
        std::mem::replace(&mut self.cells[index], cell)
    }

    pub(super) fn fill(&mut self, x: u32, y: u32, width: u32, height: u32, cell: Cell) {
        for row in y..y + height {
            let start = self.index(x, row);
            self.cells[start..start + width as usize].fill(cell);
        }
    }

    /// Whether a rectangle lies in the grid and all its cells are solid.
    pub(super) fn is_solid(&self, x: u32, y: u32, width: u32, height: u32) -> bool {
        x.checked_add(width).is_some_and(|right| right <= self.width)
            && y.checked_add(height).is_some_and(|bottom| bottom <= self.height)
            && (y..y + height).all(|row| {
                let start = self.index(x, row);
                self.cells[start..start + width as usize].iter().all(|&c| c == Cell::Solid)
            })
    }
}

/// A side of a room; north is at the top row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Side {
    North,
    East,
    South,
    West,
}

impl Side {
    /// All four sides, in the order in which doorways are drawn.
    pub const ALL: [Side; 4] = [Side::North, Side::East, Side::South, Side::West];

    /// Returns the side to which this side turns in `quarters` quarter turns counter-clockwise.
    pub fn turned(self, quarters: u8) -> Side {
        Side::ALL[(self as usize + 4 - usize::from(quarters % 4)) % 4]
    }

    /// Returns the side that becomes this one by `quarters` quarter turns counter-clockwise, and the position on it
    /// that becomes `at`. `length` gives the length of each side before the turn; positions count from the left or
    /// from the top.
    pub(super) fn before_turn(
        self,
        at: u32,
        quarters: u8,
        length: impl Fn(Side) -> u32,
    ) -> (Side, u32) {
        let original = self.turned((4 - quarters % 4) % 4);
        // Sides run from left to right and from top to bottom, so that every turn between north
        // and west, or south and east, reverses their direction.
        let reversed = match quarters % 4 {
            0 => false,
            1 => matches!(self, Side::West | Side::East),
            2 => true,
            _ => matches!(self, Side::North | Side::South),
        };
        (original, if reversed { length(original).saturating_sub(at) } else { at })
    }
}

/// A set of sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sides(u8);

impl Sides {
    /// Returns whether a side is in the set.
    pub fn contains(self, side: Side) -> bool {
        self.0 & (1 << side as u8) != 0
    }

    /// Returns the sides in the set, in the order of [`Side::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Side> {
        Side::ALL.into_iter().filter(move |&side| self.contains(side))
    }

    /// Returns the number of sides in the set.
    pub fn count(self) -> u32 {
        self.0.count_ones()
    }

    pub(super) fn insert(&mut self, side: Side) {
        self.0 |= 1 << side as u8;
    }

    /// Returns the set after `quarters` quarter turns counter-clockwise.
    pub fn turned(self, quarters: u8) -> Sides {
        let mut turned = Sides::default();
        self.iter().for_each(|side| turned.insert(side.turned(quarters)));
        turned
    }
}

/// The direction of a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// A wall from left to right, between two rows.
    Horizontal,
    /// A wall from top to bottom, between two columns.
    Vertical,
}

/// The position of an opening in a wall. The opening is one doorway wide, and its middle is at a multiple of half a
/// cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Gate {
    /// The direction of the wall.
    pub wall: Axis,
    /// The grid line of the wall: above row `line`, or left of column `line`.
    pub line: u32,
    /// Middle of the opening along the wall, in half cells from the left or from the top.
    pub at: u32,
}

impl Gate {
    /// Returns the middle in cells from the top left corner, x to the right and y down.
    pub fn middle(self) -> (f64, f64) {
        let (line, at) = (f64::from(self.line), 0.5 * f64::from(self.at));
        match self.wall {
            Axis::Horizontal => (at, line),
            Axis::Vertical => (line, at),
        }
    }

    /// Returns the cells before (above or left of) and behind the wall that the opening touches: one on either side
    /// if it lies in a cell's middle, two if it lies between cells. A cell outside the grid counts as solid.
    pub(super) fn cells(self, grid: &Grid) -> [[Cell; 2]; 2] {
        let (first, second) = ((self.at - 1) / 2, self.at / 2);
        let cell = |along: u32, line: Option<u32>| {
            let Some(line) = line else { return Cell::Solid };
            match self.wall {
                Axis::Horizontal => grid.get(along, line),
                Axis::Vertical => grid.get(line, along),
            }
            .unwrap_or_default()
        };
        let before = self.line.checked_sub(1);
        [
            [cell(first, before), cell(second, before)],
            [cell(first, Some(self.line)), cell(second, Some(self.line))],
        ]
    }

    /// Returns the position (x, y) of the first cell on either side; `None` if it is outside on the low side.
    pub(super) fn first_cells(self) -> [Option<(u32, u32)>; 2] {
        let along = (self.at - 1) / 2;
        [self.line.checked_sub(1), Some(self.line)].map(|line| {
            line.map(|line| match self.wall {
                Axis::Horizontal => (along, line),
                Axis::Vertical => (line, along),
            })
        })
    }
}

/// Writes the middle in columns and rows from the upper left corner of the grid.
impl fmt::Display for Gate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.middle();
        write!(f, "column {x}, row {y}")
    }
}

/// An opening in a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Opening {
    /// The position of the opening.
    pub gate: Gate,
    /// The reason why it exists.
    pub origin: Origin,
}

/// The reason why an opening exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// It was drawn, in the middle of a room's side.
    Drawn,
    /// It was drawn, but moved along the side to a position where it is whole.
    Shifted,
    /// It was added so that a place can be reached.
    Added,
    /// It was made by hand or read from a file.
    Edited,
}

/// Sorts openings by position and removes duplicates, since two rooms may open the same wall.
pub(in crate::indoor) fn sort_openings(openings: &mut Vec<Opening>) {
    openings.sort_unstable();
    openings.dedup_by_key(|opening| opening.gate);
}

/// Whether the same space lies behind the full width of an opening, on either side.
pub(in crate::indoor) fn is_whole(grid: &Grid, gate: Gate) -> bool {
    gate.cells(grid)
        .iter()
        .all(|&[a, b]| (a.is_floor() && b.is_floor()) || (a == b && matches!(a, Cell::Room(_))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_turn_counter_clockwise() {
        assert_eq!(Side::East.turned(1), Side::North);
        assert_eq!(Side::North.turned(1), Side::West);
        assert_eq!(Side::South.turned(3), Side::West);
        assert_eq!(Side::South.turned(2), Side::North);
        let mut sides = Sides::default();
        sides.insert(Side::North);
        sides.insert(Side::East);
        assert_eq!(sides.turned(1).iter().collect::<Vec<_>>(), [Side::North, Side::West]);
        assert_eq!(sides.turned(4), sides);
    }

    #[test]
    fn a_gate_touches_one_or_two_cells_a_side() {
        let mut grid = Grid::new(3, 2);
        grid.set(1, 0, Cell::Hallway);
        grid.set(1, 1, Cell::Room(4));
        let gate = Gate { wall: Axis::Horizontal, line: 1, at: 3 };
        assert_eq!(gate.cells(&grid), [[Cell::Hallway; 2], [Cell::Room(4); 2]]);
        let between = Gate { at: 2, ..gate };
        let below = [Cell::Solid, Cell::Room(4)];
        assert_eq!(between.cells(&grid), [[Cell::Solid, Cell::Hallway], below]);
        let edge = Gate { wall: Axis::Vertical, line: 0, at: 1 };
        assert_eq!(edge.cells(&grid), [[Cell::Solid; 2]; 2]);
        assert_eq!(edge.first_cells(), [None, Some((0, 0))]);
        assert_eq!(between.middle(), (1.0, 1.0));
    }
}
