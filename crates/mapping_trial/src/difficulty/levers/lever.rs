//! A lever and its levels.

use std::collections::BTreeMap;

use envgen::calibration::{Dials, Estimate};
use serde::{Deserialize, Serialize};

/// A setting, and the values that it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lever {
    /// Name of the setting.
    pub setting: String,
    /// Its unit.
    pub unit: String,
    /// Other settings that have a value of their own for this lever.
    #[serde(default)]
    pub with: BTreeMap<String, String>,
    /// The values.
    pub values: Vec<f64>,
}

/// What the trials of one value of a lever measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeverLevel {
    /// The value of the setting.
    pub value: f64,
    /// The mean dials over its worlds, with standard errors by the spread of worlds.
    pub dials: Dials<Estimate>,
    /// Number of worlds.
    pub maps: u32,
}
