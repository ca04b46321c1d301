//! A lever and its levels.

use std::collections::BTreeMap;

use envgen::calibration::{Dials, Estimate};
use serde::{Deserialize, Serialize};

use crate::experiment::stats::half_interval;

/// A lever: a setting, and the values that it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lever {
    /// Name of the setting.
    pub setting: String,
    /// Unit of the setting.
    pub unit: String,
    /// Other settings with values that are only used for this lever.
    #[serde(default)]
    pub with: BTreeMap<String, String>,
    /// Values of the setting.
    pub values: Vec<f64>,
}

/// What trials measured at one value of a lever.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeverLevel {
    /// The value of the setting.
    pub value: f64,
    /// Mean dials over the worlds, with standard errors by the spread of worlds.
    pub dials: Dials<Estimate>,
    /// Number of worlds.
    pub maps: u32,
}

impl LeverLevel {
    /// Returns half of Student's 95 % interval of one of the dials, by the spread of worlds.
    pub fn half_interval(&self, dial: Estimate) -> f64 {
        half_interval(dial.standard_error, f64::from(self.maps) - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_of_few_worlds_are_wider() {
        let half = |maps: u32| {
            let dial = Estimate { value: 4.0, standard_error: 1.0 };
            let dials = Dials::default().map(|()| dial);
            LeverLevel { value: 1.0, dials, maps }.half_interval(dial)
        };
        // Quantiles of Student's law for 1, 5 and many degrees of freedom.
        for (maps, expected) in [(2, 12.706), (6, 2.571), (100_000, 1.960)] {
            assert!((half(maps) - expected).abs() < 1e-3, "{maps} worlds: {}", half(maps));
        }
    }
}
