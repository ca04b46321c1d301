//! The form's choices.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

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
