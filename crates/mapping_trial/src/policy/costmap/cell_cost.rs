//! The cost of a planning cell for the robot.

/// The cost of a planning cell for the robot's centre, as in Nav2's costmaps.
///
/// A planning cell is as good as the best of its four cells of the map, so that the coarser grid closes
/// no gap that is open on the map. Distances are those of the Pioneer 3-AT, which has a radius of 0.355
/// m. Robots of another radius have the same margins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum CellCost {
    /// Free, and no obstacle known within 0.75 m.
    Open,
    /// Free, and an obstacle within 0.75 m.
    Near,
    /// Free, and an obstacle within 0.55 m.
    Close,
    /// Free, and an obstacle within 0.45 m.
    Tight,
    /// Free, and an obstacle within 0.36 m: if cells of the map are a little off, the body may fit.
    Squeeze,
    /// Not occupied, but the body would touch an obstacle.
    Inflated,
    /// Nothing is known.
    Unknown,
    /// An obstacle or water.
    Occupied,
}

impl CellCost {
    /// Returns whether a path may lead through the cell.
    #[inline]
    pub fn is_passable(self) -> bool {
        self <= CellCost::Tight
    }

    #[inline]
    pub(super) fn of(bits: u8) -> CellCost {
        match bits & 7 {
            0 => CellCost::Open,
            1 => CellCost::Near,
            2 => CellCost::Close,
            3 => CellCost::Tight,
            4 => CellCost::Squeeze,
            5 => CellCost::Inflated,
            6 => CellCost::Unknown,
            _ => CellCost::Occupied,
        }
    }
}
