//! Planning cells, by number.

use glam::IVec2;

use super::tile::{CELLS, NODES, STEPS};

/// What each of the eight steps adds to the number of a node within a tile.
const OFFSETS: [i32; STEPS.len()] = {
    let mut offsets = [0; STEPS.len()];
    let mut direction = 0;
    while direction < STEPS.len() {
        offsets[direction] = STEPS[direction].y * CELLS + STEPS[direction].x;
        direction += 1;
    }
    offsets
};

/// One planning cell: 256 per tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Node(pub(in crate::policy) u32);

impl Node {
    #[inline]
    pub(in crate::policy) fn slot(self) -> usize {
        self.0 as usize / NODES
    }

    /// Whether all neighbours are in the same tile.
    #[inline]
    pub(in crate::policy) fn is_within_tile(self) -> bool {
        let cell = self.cell();
        let is_inner = |v: i32| v > 0 && v < CELLS - 1;
        is_inner(cell.x) && is_inner(cell.y)
    }

    /// Returns the neighbour in one of [`STEPS`] of a node that is [within its
    /// tile](Node::is_within_tile).
    #[inline]
    pub(in crate::policy) fn beside(self, direction: usize) -> Node {
        Node(self.0.wrapping_add_signed(OFFSETS[direction]))
    }

    #[inline]
    pub(super) fn cell(self) -> IVec2 {
        let cell = (self.0 % NODES as u32) as i32;
        IVec2::new(cell % CELLS, cell / CELLS)
    }

    #[inline]
    pub(super) fn at(slot: usize, cell: IVec2) -> Node {
        Node(slot as u32 * NODES as u32 + (cell.y * CELLS + cell.x) as u32)
    }
}
