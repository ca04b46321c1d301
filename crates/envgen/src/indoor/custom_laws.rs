//! Indoor maps drawn from distributions of the caller.

#[cfg(feature = "rand")]
use rand::distr::Distribution;

use super::adaptation::{self, LEAST_SPACING};
use super::catalogue::{MAX_ROOM_SIZE, SharedRoom};
use super::dimensions::Dimensions;
use super::error::IndoorError;
use super::room_placement::DESIGN_UNIT;
use super::variation::{FARTHEST_MOVE, GREATEST_TURN, Varied, vary};
#[cfg(feature = "rand")]
use crate::distribution::law;
use crate::distribution::{Law, standard_normal};
use crate::seed::Stream;

/// The greatest move that a distribution may give, in metres: the size of the largest room.
const MAX_MOVE: f64 = MAX_ROOM_SIZE as f64 * DESIGN_UNIT;

/// The greatest angle that a distribution may give, in radians. It is the greatest heading in a room, beyond which
/// the fraction of a turn is lost in rounding.
const MAX_TURN: f64 = 1e3;

/// Distributions that replace those of an [`IndoorSpec`](super::IndoorSpec) in `IndoorSpec::generate_with_laws`.
///
/// ```
/// use envgen::Seed;
/// use envgen::distribution::Truncated;
/// use envgen::indoor::{IndoorLaws, IndoorSpec};
/// use rand_distr::{Normal, Uniform};
///
/// // Hallways 4 to 6 cells apart, and contents that are moved by about 20 cm, never turned.
/// let laws = IndoorLaws::new()
///     .spacing(Uniform::new_inclusive(4.0, 6.0)?)
///     .moves(Truncated::new(Normal::new(0.0, 0.2)?, -1.0, 1.0)?)
///     .turns(Uniform::new_inclusive(0.0, 0.0)?);
/// let spec = IndoorSpec { clearance: Some(1.0), ..Default::default() };
/// let plan = spec.generate_with_laws(Seed(1), &laws)?;
/// assert!(plan.is_edited());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
#[cfg_attr(
    not(feature = "rand"),
    expect(unreachable_pub, reason = "it is public with the feature `rand`")
)]
pub struct IndoorLaws<'a> {
    spacing: Option<Box<Law<'a>>>,
    moves: Option<Box<Law<'a>>>,
    turns: Option<Box<Law<'a>>>,
}

#[cfg(feature = "rand")]
impl<'a> IndoorLaws<'a> {
    /// Creates a set without distributions, which keeps those of the spec.
    pub fn new() -> Self {
        IndoorLaws::default()
    }

    /// Sets the distribution of the distance between parallel hallways in cells, which must lie from 3 to one less
    /// than the map's width or height and is then rounded to whole cells. It is drawn for the vertical hallways
    /// first, then for the horizontal ones, and is unused if the spec sets `spacing_h` or `spacing_v`. The distance
    /// then no longer depends on the difficulty.
    pub fn spacing(self, spacing: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        IndoorLaws { spacing: Some(law(spacing)), ..self }
    }

    /// Sets the distribution of how far one change moves an object of a room along each of its two axes, in metres
    /// of the room's design, from -192 to 192. Objects are moved if the spec sets a `clearance`; a move that leaves
    /// the room, or brings the room no nearer to the clearance, is undone. The generator's own distribution is
    /// uniform from -0.6 to 0.6 m.
    pub fn moves(self, moves: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        IndoorLaws { moves: Some(law(moves)), ..self }
    }

    /// Sets the distribution of the angle by which one change turns an object of a room, in radians,
    /// counter-clockwise, from -1000 to 1000. It is used as in [`IndoorLaws::moves`]; the generator's own
    /// distribution is uniform from -1 to 1.
    pub fn turns(self, turns: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        IndoorLaws { turns: Some(law(turns)), ..self }
    }
}

impl IndoorLaws<'_> {
    /// Whether there is any distribution.
    pub(super) fn any(&self) -> bool {
        self.spacing.is_some() || self.moves.is_some() || self.turns.is_some()
    }

    /// Draws the distance between hallways in cells, before it is rounded.
    pub(super) fn hallway_spacing(
        &self,
        difficulty: f64,
        size: u32,
        stream: &mut Stream,
    ) -> Result<f64, IndoorError> {
        let Some(law) = &self.spacing else {
            return Ok(adaptation::spacing_raw(difficulty, size, standard_normal(stream)));
        };
        let (value, max) = (law(stream), size - 1);
        if (f64::from(LEAST_SPACING)..=f64::from(max)).contains(&value) {
            Ok(value)
        } else {
            Err(IndoorError::Spacing { value, max })
        }
    }

    /// Calls [`vary`] with these distributions.
    pub(super) fn vary(
        &self,
        room: &SharedRoom,
        wanted: f64,
        dimensions: Dimensions,
        stream: &mut Stream,
    ) -> Result<Varied, IndoorError> {
        let moves = |stream: &mut Stream| match &self.moves {
            None => Ok(stream.between(-FARTHEST_MOVE, FARTHEST_MOVE)),
            Some(law) => within(law(stream), MAX_MOVE)
                .map_err(|value| IndoorError::Move { value, max: MAX_MOVE }),
        };
        let turns = |stream: &mut Stream| match &self.turns {
            None => Ok(stream.between(-GREATEST_TURN, GREATEST_TURN)),
            Some(law) => within(law(stream), MAX_TURN)
                .map_err(|value| IndoorError::Turn { value, max: MAX_TURN }),
        };
        vary(room, wanted, dimensions, stream, &moves, &turns)
    }
}

/// Checks that a number lies from -`most` to `most`; otherwise the number is the error.
fn within(value: f64, most: f64) -> Result<f64, f64> {
    if value.abs() <= most { Ok(value) } else { Err(value) }
}
