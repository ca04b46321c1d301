//! Rows of cells in one number: those of a tile, with as many of its neighbours' as fit.

use glam::IVec2;

use super::tile::{Tile, Tiles};
use crate::map::TILE;

/// A row of a tile with [`Row::SIDE`] columns on either side.
pub(super) trait Row: Copy + Default + Eq {
    /// Columns on either side, and the greatest reach of inflation.
    const SIDE: i32;

    /// The occupied cells, and water, in a row of a tile: rows below 0 and over the last are those of
    /// the tiles below and above.
    fn solid(tiles: &Tiles, slot: usize, row: i32) -> Self;

    /// The tile's own columns.
    fn middle(self) -> u32;

    /// The set bits and their neighbours.
    fn widened(self) -> Self;
}

fn solid(tile: &Tile, row: usize) -> u32 {
    tile.occupied[row] | tile.water[row]
}

/// 32 columns with 16 on either side: for robots of the Pioneer's size and smaller ones.
impl Row for u64 {
    const SIDE: i32 = 16;

    #[inline]
    fn solid(tiles: &Tiles, slot: usize, row: i32) -> Self {
        tiles.wide_row(slot, row, 0, solid)
    }

    #[inline]
    fn middle(self) -> u32 {
        (self >> 16) as u32
    }

    #[inline]
    fn widened(self) -> Self {
        self | self << 1 | self >> 1
    }
}

/// 32 columns with 48 on either side: for larger robots.
impl Row for u128 {
    const SIDE: i32 = 48;

    fn solid(tiles: &Tiles, slot: usize, row: i32) -> Self {
        let at = tiles[slot].at;
        let (up, row) = (row.div_euclid(TILE), row.rem_euclid(TILE) as usize);
        let mut bits = 0;
        for right in -2..=2 {
            let Some(slot) = tiles.slot_of(at + IVec2::new(right, up)) else { continue };
            let columns = u128::from(solid(&tiles[slot as usize], row));
            let shift = TILE * right + u128::SIDE;
            bits |= if shift < 0 { columns >> -shift } else { columns << shift };
        }
        bits
    }

    #[inline]
    fn middle(self) -> u32 {
        (self >> 48) as u32
    }

    #[inline]
    fn widened(self) -> Self {
        self | self << 1 | self >> 1
    }
}
