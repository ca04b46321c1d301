//! The index of tiles by column and row.

use glam::IVec2;

/// A tile that does not exist.
pub(super) const NONE: u32 = u32::MAX;

/// Slots of tiles by column and row.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    corner: IVec2,
    size: IVec2,
    slots: Vec<u32>,
}

impl Table {
    /// The slot of a tile; `None` if it does not exist.
    #[inline]
    pub(super) fn get(&self, at: IVec2) -> Option<u32> {
        let place = at.wrapping_sub(self.corner);
        if place.x < 0 || place.y < 0 || place.x >= self.size.x || place.y >= self.size.y {
            return None;
        }
        let slot = self.slots[place.y as usize * self.size.x as usize + place.x as usize];
        (slot != NONE).then_some(slot)
    }

    /// Gives a tile its slot. The table grows to be as large as the map's own, which is bounded.
    pub(super) fn set(&mut self, at: IVec2, slot: u32) {
        let empty = self.slots.is_empty();
        let low = if empty { at } else { self.corner.min(at) };
        let high = if empty { at } else { (self.corner + self.size - 1).max(at) };
        let size = high - low + 1;
        if (low, size) != (self.corner, self.size) {
            let mut slots = vec![NONE; size.x as usize * size.y as usize];
            let shift = self.corner - low;
            for row in 0..self.size.y {
                let from = row as usize * self.size.x as usize;
                let to = (row + shift.y) as usize * size.x as usize + shift.x as usize;
                let len = self.size.x as usize;
                slots[to..to + len].copy_from_slice(&self.slots[from..from + len]);
            }
            (self.corner, self.size, self.slots) = (low, size, slots);
        }
        let place = at - self.corner;
        self.slots[place.y as usize * self.size.x as usize + place.x as usize] = slot;
    }
}
