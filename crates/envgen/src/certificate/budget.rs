//! Limits of the cost of a check, and the reasons why a claim is undecided.

use std::error::Error;
use std::fmt;

/// The greatest number of convex pieces (trees, boxes, segments, sides of polygons) in a check. Each takes about
/// 100 bytes.
pub const MAX_PIECES: usize = 1 << 23;

/// The greatest number of comparisons of a piece with a point per claim, which take a few seconds. Other work is
/// counted in the same unit.
pub const MAX_COMPARISONS: u64 = 1 << 29;

/// The greatest number of comparisons per piece, which applies if it gives more in total than [`MAX_COMPARISONS`],
/// as in long hallways and large buildings. It takes a minute per million pieces.
pub const MAX_COMPARISONS_PER_PIECE: u64 = 1 << 14;

/// The greatest number of squares into which free space is divided to find its places. Each takes 8 bytes.
pub const MAX_SQUARES: usize = 1 << 25;

/// The greatest number of discs of free space that are joined to a path. Each takes about 200 bytes.
pub const MAX_BUBBLES: usize = 1 << 21;

/// The greatest number of points on a world's roads at which bends are measured.
pub const MAX_BEND_POINTS: u64 = 1 << 23;

/// The reasons why a claim is undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Doubt {
    /// Up to rounding, two parts, or a part and a pose, are exactly as far apart as the robot is wide.
    TooClose,
    /// The world has more than [`MAX_PIECES`] pieces.
    Pieces,
    /// The check would need more comparisons than [`MAX_COMPARISONS`] and [`MAX_COMPARISONS_PER_PIECE`] allow.
    Comparisons,
    /// The check would need more than [`MAX_SQUARES`] squares.
    Squares,
    /// The check would need more than [`MAX_BEND_POINTS`] points.
    BendPoints,
    /// The prediction was made by another version of the calibration.
    OtherCalibration,
    /// This field of the claim says nothing that can be checked: a distance that is negative or not finite, an area
    /// that is empty or not finite, or a dial that is not finite.
    Indefinite(&'static str),
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
            Doubt::Indefinite(field @ ("area" | "torus")) => {
                write!(f, "`{field}` must be finite and not empty")
            }
            Doubt::Indefinite(field @ ("difficulty" | "mapping" | "navigation")) => {
                write!(f, "`{field}` must be finite, with a standard error of at least 0")
            }
            Doubt::Indefinite(field) => {
                write!(f, "`{field}` must be a finite number of at least 0")
            }
            Doubt::BendPoints => write!(f, "the roads need more than {MAX_BEND_POINTS} points"),
        }
    }
}

impl Error for Doubt {}

/// The number of comparisons that are left.
pub(super) struct Budget(u64);

impl Budget {
    pub(super) fn new(comparisons: u64) -> Self {
        Budget(comparisons)
    }

    /// Adds the number by which the limit for a world of so many pieces exceeds [`MAX_COMPARISONS`].
    pub(super) fn grow(&mut self, pieces: usize) {
        let all = MAX_COMPARISONS_PER_PIECE * pieces as u64;
        self.0 += all.saturating_sub(MAX_COMPARISONS);
    }

    /// Splits off half of the remaining comparisons.
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
