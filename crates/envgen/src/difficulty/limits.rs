//! How large and how dense the worlds of difficulty vectors may be.

/// The most cells of the grid; larger worlds have larger cells.
pub const MAX_CELLS: usize = 1 << 18;

/// The greatest side of a cell in metres: in larger ones a robot's ground and moves mean little.
pub const MAX_CELL: f64 = 5.0;

/// The most distances to solids that all clearances take, about a second's worth, a polygon counting once for
/// each corner: where solids are piled on each other, each clearance takes many.
pub const MAX_READS: usize = 1 << 28;
