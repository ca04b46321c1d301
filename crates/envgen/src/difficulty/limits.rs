//! The limits of worlds for which difficulty vectors are computed.

/// The greatest number of cells of the grid. Larger worlds have larger cells.
pub const MAX_CELLS: usize = 1 << 18;

/// The greatest side of a cell in metres. In larger cells, a robot's ground and moves would mean little.
pub const MAX_CELL: f64 = 5.0;

/// The greatest number of distances to solids that all clearances may take, which is about a second's work. A
/// polygon counts once for each corner. If solids are piled on each other, each clearance takes many distances.
pub const MAX_READS: usize = 1 << 28;
