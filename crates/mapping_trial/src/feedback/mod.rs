//! The form that an operator fills after a run: appendix B of Zwennes (2011), and two questions
//! that separate what its one rating mixed.

mod ask;
#[cfg(feature = "experiment")]
mod link;
mod measured;
pub mod questions;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use ask::{FeedbackError, MAX_LINE, ask};
#[cfg(feature = "experiment")]
pub use link::{
    DifficultySource, LEAST_SESSIONS, LinkError, PanelDifficulty, RatedWorld, RatingLink,
    UnknownDifficulty,
};
pub use measured::Measured;

/// The filled form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feedback {
    /// Name of the operator: a person, a policy or a driver.
    pub name: String,
    /// Experience level as operator.
    pub experience: Experience,
    /// The environment and the setup, which the form asks for as well.
    #[serde(flatten)]
    pub session: Session,
    /// Overall difficulty of the environment: 0 when nothing in it forces a mapping error on the
    /// robot, 10 when the map cannot be navigated, due to excessive mapping errors.
    pub difficulty: Rating,
    /// How difficult it was to map. Not in the original form.
    pub mapping: Rating,
    /// How difficult it was to get around. Not in the original form.
    pub getting_around: Rating,
    /// What contributed most to the difficulty.
    pub contributed: String,
    /// Rooms that were particularly difficult, and why.
    pub difficult_rooms: String,
    /// Rooms that were particularly easy, and why.
    pub easy_rooms: String,
    /// Patterns in the layout (hallways, dead ends, doorways), and what they did.
    pub patterns: String,
    /// Anything else.
    pub other: String,
}

/// What was mapped, and with what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// File or name of the environment.
    pub environment: String,
    /// Software that ran the simulation.
    pub software: String,
    /// How robots and operator were connected.
    pub connection: Connection,
    /// Number and type of robots.
    pub robots: String,
}

impl Session {
    /// A run of this crate: robots of this type, under direct control.
    pub fn new(environment: &str, robots: usize) -> Self {
        Session {
            environment: environment.to_owned(),
            software: format!("mapping_trial {}", env!("CARGO_PKG_VERSION")),
            connection: Connection::Direct,
            robots: format!("{robots}x P3AT"),
        }
    }
}

/// An enum whose variants have names in the form and in files.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $name {
            /// Every choice, in the form's order.
            pub const ALL: &'static [$name] = &[$($name::$variant),+];
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $($name::$variant => $text,)+
                })
            }
        }

        impl FromStr for $name {
            type Err = NoChoice;

            /// By name in upper or lower case, or by number from 1.
            fn from_str(text: &str) -> Result<Self, NoChoice> {
                let text = text.trim();
                let number = text.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
                let found = number.and_then(|n| $name::ALL.get(n)).or_else(|| {
                    $name::ALL.iter().find(|choice| choice.to_string().eq_ignore_ascii_case(text))
                });
                found.copied().ok_or_else(|| {
                    let all: Vec<String> = $name::ALL.iter().map(ToString::to_string).collect();
                    NoChoice { value: text.to_owned(), allowed: all.join(", ") }
                })
            }
        }
    };
}

choices! {
    /// Experience as an operator.
    Experience {
        /// None.
        #[default]
        None = "none",
        /// From experiments.
        Experimental = "experimental",
        /// From one competition.
        SingleCompetition = "single competition",
        /// From several competitions.
        MultipleCompetitions = "multiple competitions",
    }
}

choices! {
    /// How a robot and its operator are connected, as in `USARSim`.
    Connection {
        /// Always.
        #[default]
        Direct = "Direct",
        /// By a model of radio propagation.
        PropagationModel = "PropagationModel",
        /// Up to a distance.
        DistanceOnly = "DistanceOnly",
        /// By a model of radio propagation that includes obstacles.
        ObstaclePropagationModel = "ObstaclePropagationModel",
    }
}

/// A word that is not one of the form's choices.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{value}` is unknown, expected one of: {allowed}")]
pub struct NoChoice {
    /// The word.
    pub value: String,
    /// The choices.
    pub allowed: String,
}

/// A rating from 0 to 10.
///
/// ```
/// use mapping_trial::feedback::Rating;
///
/// let rating: Rating = " 7.5 ".parse()?;
/// assert_eq!(rating.value(), 7.5);
/// assert!(Rating::try_from(10.5).is_err() && Rating::try_from(f64::NAN).is_err());
/// # Ok::<(), mapping_trial::feedback::NoRating>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Rating(f64);

/// A number that is not a rating.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("a rating must be a number from 0 to 10, got `{0}`")]
pub struct NoRating(String);

impl Rating {
    /// The rating as a number.
    pub fn value(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Rating {
    type Error = NoRating;

    fn try_from(value: f64) -> Result<Self, NoRating> {
        if (0.0..=10.0).contains(&value) {
            Ok(Rating(value))
        } else {
            Err(NoRating(value.to_string()))
        }
    }
}

impl From<Rating> for f64 {
    fn from(rating: Rating) -> f64 {
        rating.0
    }
}

impl FromStr for Rating {
    type Err = NoRating;

    fn from_str(text: &str) -> Result<Self, NoRating> {
        let value: f64 = text.trim().parse().map_err(|_| NoRating(text.trim().to_owned()))?;
        Rating::try_from(value)
    }
}

impl fmt::Display for Rating {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests;
