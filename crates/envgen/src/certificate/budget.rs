//! The limits of a check's cost, and why a claim is undecided.

use std::error::Error;
use std::fmt;

/// The most convex pieces (trees, boxes, segments, sides of polygons) of which a check keeps track:
/// about 100 bytes each.
pub const MAX_PIECES: usize = 1 << 23;

/// The most comparisons of a piece with a point per claim, with other work counted in the same unit:
/// a few seconds.
pub const MAX_COMPARISONS: u64 = 1 << 29;

/// The most comparisons per piece where this is more in all, as in long hallways and large buildings: a minute
/// per million pieces.
pub const MAX_COMPARISONS_PER_PIECE: u64 = 1 << 14;

/// The most squares into which free space is divided to find its places: 8 bytes each.
pub const MAX_SQUARES: usize = 1 << 25;

/// The most discs of free space that are joined to a path: about 200 bytes each.
pub const MAX_BUBBLES: usize = 1 << 21;

/// The most points of its roads at which a world's bends are measured.
pub const MAX_BEND_POINTS: u64 = 1 << 23;

/// Why a claim is undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Doubt {
    /// Two parts, or a part and a pose, are as far apart as the robot is wide, up to rounding.
    TooClose,
    /// The world has more than [`MAX_PIECES`] pieces.
    Pieces,
    /// More than [`MAX_COMPARISONS`] comparisons would be needed.
    Comparisons,
    /// More than [`MAX_SQUARES`] squares would be needed.
    Squares,
    /// More than [`MAX_BEND_POINTS`] points would be needed.
    BendPoints,
    /// The world was predicted by another calibration.
    OtherCalibration,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Doubt::TooClose => f.write_str("a gap is as wide as the robot, up to rounding"),
            Doubt::Pieces => write!(f, "the world has more than {MAX_PIECES} convex pieces"),
            Doubt::Comparisons => write!(
                f,
                "the budget of {MAX_COMPARISONS} comparisons, or {MAX_COMPARISONS_PER_PIECE} per piece, is spent"
            ),
            Doubt::Squares => {
                write!(f, "the budget of {MAX_SQUARES} squares of free space is spent")
            }
            Doubt::OtherCalibration => f.write_str("another calibration predicted it"),
            Doubt::BendPoints => write!(f, "the roads need more than {MAX_BEND_POINTS} points"),
        }
    }
}

impl Error for Doubt {}

/// Comparisons that are left.
pub(super) struct Budget(u64);

impl Budget {
    pub(super) fn new(comparisons: u64) -> Self {
        Budget(comparisons)
    }

    /// Adds what a claim about a world of so many pieces may cost more than [`MAX_COMPARISONS`].
    pub(super) fn grow(&mut self, pieces: usize) {
        let all = MAX_COMPARISONS_PER_PIECE * pieces as u64;
        self.0 += all.saturating_sub(MAX_COMPARISONS);
    }

    /// Splits off half of what is left.
    pub(super) fn half(&mut self) -> Budget {
        let half = self.0 / 2;
        self.0 -= half;
        Budget(half)
    }

    /// Subtracts the cost of a step.
    pub(super) fn spend(&mut self, comparisons: u64) -> Result<(), Doubt> {
        self.0 = self.0.checked_sub(comparisons).ok_or(Doubt::Comparisons)?;
        Ok(())
    }
}
