//! The dial that the proof is about.

use envgen::calibration::Dials;
use envgen::indoor::{IndoorSpec, Profile};
use serde::{Deserialize, Serialize};
use strum::VariantNames;

use crate::names::Named;

/// The dial that is requested and measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Dial {
    /// The difficulty as a whole.
    #[default]
    Difficulty,
    /// The difficulty of mapping.
    Mapping,
    /// The difficulty of navigation.
    Navigation,
}

impl Named for Dial {
    const FIELD: &'static str = "dial";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("difficulty", Dial::Difficulty),
        ("mapping", Dial::Mapping),
        ("navigation", Dial::Navigation),
    ];
}

impl Dial {
    /// Returns the value of this dial.
    pub fn of<T>(self, dials: Dials<T>) -> T {
        match self {
            Dial::Difficulty => dials.difficulty,
            Dial::Mapping => dials.mapping,
            Dial::Navigation => dials.navigation,
        }
    }

    /// Returns a spec of the profile `calibrated` that requests a value of this dial alone.
    pub(super) fn request(self, base: IndoorSpec, value: f64) -> IndoorSpec {
        let spec = IndoorSpec { profile: Profile::Calibrated, ..base };
        match self {
            Dial::Difficulty => IndoorSpec { difficulty: value, ..spec },
            Dial::Mapping => IndoorSpec { mapping: Some(value), ..spec },
            Dial::Navigation => IndoorSpec { navigation: Some(value), ..spec },
        }
    }

    /// Returns the dial in words.
    pub(super) fn text(self) -> &'static str {
        match self {
            Dial::Difficulty => "difficulty",
            Dial::Mapping => "difficulty of mapping",
            Dial::Navigation => "difficulty of navigation",
        }
    }

    pub(super) fn is_default(&self) -> bool {
        *self == Dial::default()
    }
}
