//! What a planning cell is for the robot.

/// What a planning cell is for the robot's middle.
///
/// A planning cell is as good as the best of its four cells of the map, so that the coarser grid
/// closes no gap that is open on the map. Distances are those of the Pioneer 3-AT, of 0.355 m; the
/// margins around a robot of another radius are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// Free, and nothing known within 0.75 m.
    Open,
    /// Free, and something within 0.75 m.
    Near,
    /// Free, and something within 0.55 m.
    Close,
    /// Free, and something within 0.45 m.
    Tight,
    /// Free, and something within 0.36 m: where cells of the map are a little off, the body may fit.
    Squeeze,
    /// Nothing stands here, but the body would touch something.
    Inflated,
    /// Nothing is known.
    Unknown,
    /// Something stands here, or it is water.
    Occupied,
}

impl Class {
    /// Whether a plan may lead through the cell.
    pub fn is_passable(self) -> bool {
        self <= Class::Tight
    }

    pub(super) fn of(bits: u8) -> Class {
        match bits & 7 {
            0 => Class::Open,
            1 => Class::Near,
            2 => Class::Close,
            3 => Class::Tight,
            4 => Class::Squeeze,
            5 => Class::Inflated,
            6 => Class::Unknown,
            _ => Class::Occupied,
        }
    }
}
