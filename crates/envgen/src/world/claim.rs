//! The promises that generators make of worlds.

use std::fmt;

use glam::DVec2;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::changed_settings::rounded;
use crate::dials::Prediction;
use crate::geometry::Rect;

/// A promise that a generator makes of a world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Claim {
    /// A disc of this radius can move from the start to the goal without touching solids or ground that no robot
    /// can enter.
    Connected {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// No two trees' centres are nearer to each other than this.
    TreeDistance {
        /// Least distance in metres.
        distance: f64,
        /// Width and height in metres of the area, if distances count across its sides, which are joined.
        torus: Option<DVec2>,
    },
    /// Whether a disc can cross an area from its west side to its east side while its centre stays inside the area.
    CrossesWestEast {
        /// The area.
        area: Rect,
        /// Radius of the disc in metres.
        radius: f64,
        /// Whether the disc can cross.
        crosses: bool,
        /// Whether theory predicts that a disc can cross a wide forest of this density; absent where there is no
        /// theory.
        #[serde(
            default,
            skip_serializing_if = "Option::is_none",
            serialize_with = "write_flag",
            deserialize_with = "read_flag"
        )]
        predicted: Option<bool>,
    },
    /// No bend of a road has a smaller radius than this.
    BendRadius {
        /// Least radius in metres.
        radius: f64,
    },
    /// From the start, a disc of this radius can reach every room (or every part of a room that its contents
    /// divide) and every piece of the hallways and open areas. Only places count where the disc has a clearance of
    /// [`PLACE_MARGIN`](crate::certificate::PLACE_MARGIN) to spare.
    EveryPlaceReachable {
        /// Radius of the disc in metres.
        radius: f64,
    },
    /// No lintel over a doorway is lower than this, so that robots up to this height can pass below it.
    Headroom {
        /// Height in metres.
        height: f64,
    },
    /// Trials in the world are predicted to measure this difficulty.
    PredictedDifficulty {
        /// The prediction of the crate's calibration.
        prediction: Prediction,
    },
    /// This doorway was added, and left open, so that some place can be reached.
    AddedDoorway {
        /// Its index in [`World::doorways`](super::World::doorways).
        doorway: u32,
    },
}

impl Claim {
    /// Whether its distances are finite and not negative, and its area finite and not empty.
    pub(crate) fn is_definite(&self) -> bool {
        self.indefinite().is_none()
    }

    /// Returns the name of the first field that keeps the claim from being definite; `None` if it is.
    pub(crate) fn indefinite(&self) -> Option<&'static str> {
        let unless = |is_definite: bool, name| (!is_definite).then_some(name);
        match *self {
            Claim::Connected { radius }
            | Claim::BendRadius { radius }
            | Claim::EveryPlaceReachable { radius } => unless(is_distance(radius), "radius"),
            Claim::TreeDistance { distance, torus } => {
                let is_size = |size: DVec2| size.is_finite() && size.cmpgt(DVec2::ZERO).all();
                unless(is_distance(distance), "distance")
                    .or_else(|| unless(torus.is_none_or(is_size), "torus"))
            }
            Claim::CrossesWestEast { area, radius, .. } => {
                let finite = area.min.is_finite() && area.max.is_finite();
                unless(is_distance(radius), "radius")
                    .or_else(|| unless(finite && area.min.cmplt(area.max).all(), "area"))
            }
            Claim::Headroom { height } => unless(is_distance(height), "height"),
            Claim::PredictedDifficulty { prediction } => prediction
                .dials
                .named()
                .into_iter()
                .find(|(_, dial)| !(dial.value.is_finite() && is_distance(dial.standard_error)))
                .map(|(name, _)| name),
            Claim::AddedDoorway { .. } => None,
        }
    }
}

/// Whether a number is a distance: finite, and at least 0.
pub(crate) fn is_distance(number: f64) -> bool {
    number.is_finite() && number >= 0.0
}

/// Writes a flag as files had it before it could be absent, without `Some`.
fn write_flag<S: Serializer>(flag: &Option<bool>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(flag.unwrap_or_default())
}

fn read_flag<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<bool>, D::Error> {
    bool::deserialize(deserializer).map(Some)
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the last digits, such as those of 0.7999999999999972.
        let short = |length: &f64| rounded(*length, 12);
        match self {
            Claim::Connected { radius } => {
                write!(f, "a disc of radius {} m can move from start to goal", short(radius))
            }
            Claim::TreeDistance { distance, .. } => {
                write!(f, "no two trees' centres are nearer than {} m", short(distance))
            }
            Claim::CrossesWestEast { radius, crosses, predicted, .. } => {
                let word = |can: bool| if can { "can" } else { "cannot" };
                write!(
                    f,
                    "a disc of radius {} m {} cross from west to east",
                    short(radius),
                    word(*crosses)
                )?;
                predicted.map_or(Ok(()), |can| write!(f, " (predicted: {})", word(can)))
            }
            Claim::BendRadius { radius } => {
                write!(f, "no bend of a road is tighter than {} m", short(radius))
            }
            Claim::EveryPlaceReachable { radius } => {
                write!(f, "a disc of radius {} m can reach every room and hallway", short(radius))
            }
            Claim::Headroom { height } => {
                write!(f, "no lintel is lower than {} m", short(height))
            }
            Claim::PredictedDifficulty { prediction } => {
                let [d, m, n] = prediction
                    .dials
                    .named()
                    .map(|(_, dial)| format!("{:.1} +- {:.1}", dial.value, dial.standard_error));
                write!(f, "predicted difficulty {d}, mapping {m}, navigation {n}")
            }
            Claim::AddedDoorway { doorway } => {
                write!(f, "doorway {doorway} was added so that a place can be reached")
            }
        }
    }
}
