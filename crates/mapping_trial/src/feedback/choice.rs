//! The choices in the form.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Declares an enum whose variants have names in the form and in files.
macro_rules! choices {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $name {
            /// All choices, in the order of the form.
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

            /// Parses a name, in upper or lower case, or a number from 1.
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
        /// No experience.
        #[default]
        None = "none",
        /// Experience from experiments.
        Experimental = "experimental",
        /// Experience from one competition.
        SingleCompetition = "single competition",
        /// Experience from several competitions.
        MultipleCompetitions = "multiple competitions",
    }
}

choices! {
    /// How a robot is connected with its operator, as in `USARSim`.
    Connection {
        /// Always connected.
        #[default]
        Direct = "Direct",
        /// Connected by a model of radio propagation.
        PropagationModel = "PropagationModel",
        /// Connected up to a distance.
        DistanceOnly = "DistanceOnly",
        /// Connected by a model of radio propagation that includes obstacles.
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
