//! Planning cells by number.

use glam::IVec2;

use super::{CELLS, NODES};

/// One planning cell: 256 per tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node(pub(in crate::policy) u32);

impl Node {
    pub(in crate::policy) fn slot(self) -> usize {
        self.0 as usize / NODES
    }

    pub(super) fn cell(self) -> IVec2 {
        let cell = (self.0 % NODES as u32) as i32;
        IVec2::new(cell % CELLS, cell / CELLS)
    }

    pub(super) fn at(slot: usize, cell: IVec2) -> Node {
        Node(slot as u32 * NODES as u32 + (cell.y * CELLS + cell.x) as u32)
    }
}
