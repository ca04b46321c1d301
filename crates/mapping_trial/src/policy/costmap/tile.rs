//! The tiles of a costmap.

use std::ops::{Index, IndexMut};

use glam::IVec2;

use super::table::{NONE, Table};
use crate::map::{RESOLUTION, TILE};

/// Number of planning cells along a side of a tile of the map. Each of them holds 2 x 2 cells of the
/// map.
pub const CELLS: i32 = TILE / 2;

/// Side of a planning cell in metres.
pub const SIDE: f64 = 2.0 * RESOLUTION;

/// Number of planning cells in a tile.
pub(in crate::policy) const NODES: usize = (CELLS * CELLS) as usize;

/// Index of no step, after the eight of [`STEPS`].
const HERE: usize = STEPS.len();

/// The eight steps from a cell to its neighbours, counter-clockwise from +x. Those with odd indices are
/// diagonal.
pub(in crate::policy) const STEPS: [IVec2; 8] = [
    IVec2::new(1, 0),
    IVec2::new(1, 1),
    IVec2::new(0, 1),
    IVec2::new(-1, 1),
    IVec2::new(-1, 0),
    IVec2::new(-1, -1),
    IVec2::new(0, -1),
    IVec2::new(1, -1),
];

/// What is known of the cells of a tile of the map.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    pub(super) at: IVec2,
    /// Slots of the neighbouring tiles, in the order of [`STEPS`].
    pub(super) around: [u32; 8],
    /// A bit for each occupied cell, column 0 lowest, row by row from below.
    pub(super) occupied: Bits,
    pub(super) free: Bits,
    /// Cells where water was seen, which no map of walls shows.
    pub(super) water: Bits,
    pub(super) frontier: Bits,
    /// Whether any cell is occupied.
    pub(super) has_occupied: bool,
    pub(super) stale_costs: bool,
    pub(super) stale_frontier: bool,
}

/// A bit per cell of a tile, column 0 lowest, row by row from below.
pub(in crate::policy) type Bits = [u32; TILE as usize];

/// All tiles, by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct Tiles {
    table: Table,
    list: Vec<Tile>,
}

impl Index<usize> for Tiles {
    type Output = Tile;

    #[inline]
    fn index(&self, slot: usize) -> &Tile {
        &self.list[slot]
    }
}

impl IndexMut<usize> for Tiles {
    #[inline]
    fn index_mut(&mut self, slot: usize) -> &mut Tile {
        &mut self.list[slot]
    }
}

impl Tiles {
    /// The slot of a tile by column and row.
    #[inline]
    pub(super) fn slot_of(&self, at: IVec2) -> Option<u32> {
        self.table.get(at)
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    pub(super) fn iter(&self) -> std::slice::Iter<'_, Tile> {
        self.list.iter()
    }

    pub(super) fn iter_mut(&mut self) -> std::slice::IterMut<'_, Tile> {
        self.list.iter_mut()
    }

    /// Adds an unknown tile, and returns its slot.
    pub(super) fn add(&mut self, at: IVec2) -> usize {
        let slot = self.list.len() as u32;
        self.table.set(at, slot);
        let around = STEPS.map(|step| self.table.get(at + step).unwrap_or(NONE));
        for (direction, &other) in around.iter().enumerate() {
            if other != NONE {
                self.list[other as usize].around[(direction + 4) % 8] = slot;
            }
        }
        let empty = [0; TILE as usize];
        self.list.push(Tile {
            at,
            around,
            occupied: empty,
            free: empty,
            water: empty,
            frontier: empty,
            has_occupied: false,
            stale_costs: true,
            stale_frontier: false,
        });
        slot as usize
    }

    /// Returns a row of a tile with 16 columns of the tiles on either side. Rows below 0 and above the
    /// last are those of the tiles below and above.
    #[inline]
    pub(super) fn wide_row(
        &self,
        slot: usize,
        row: i32,
        missing: u32,
        of: impl Fn(&Tile, usize) -> u32,
    ) -> u64 {
        let tile = &self.list[slot];
        let directions = if row < 0 {
            [5, 6, 7]
        } else if row >= TILE {
            [3, 2, 1]
        } else {
            [4, HERE, 0]
        };
        let row = row.rem_euclid(TILE) as usize;
        let [left, middle, right] = directions.map(|direction| match tile.around.get(direction) {
            None => of(tile, row),
            Some(&slot) => self.list.get(slot as usize).map_or(missing, |tile| of(tile, row)),
        });
        u64::from(left >> 16) | u64::from(middle) << 16 | u64::from(right & 0xffff) << 48
    }
}
