//! Grids of square cells: their geometry, the cells that shapes touch, their largest region, and indices by cell.

mod cover;
mod frame;
mod index;
mod region;

pub(crate) use cover::Convex;
pub use frame::GridFrame;
pub(crate) use index::{CellBuckets, GridIndex, MAX_CELLS, finest_frame, index_area};
pub(crate) use region::largest_region;
