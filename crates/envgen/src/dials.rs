//! The dials of difficulty, and predictions of them.

use serde::{Deserialize, Serialize};

/// One value for each dial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dials<T> {
    /// The difficulty as a whole, `d`, from the score D.
    pub difficulty: T,
    /// How hard mapping is, `m`, from the score M.
    pub mapping: T,
    /// How hard navigation is, `n`, from the score N.
    pub navigation: T,
}

impl<T> Dials<T> {
    /// One value for each dial, from the dial before.
    pub fn map<U>(self, mut to: impl FnMut(T) -> U) -> Dials<U> {
        Dials {
            difficulty: to(self.difficulty),
            mapping: to(self.mapping),
            navigation: to(self.navigation),
        }
    }

    /// The dials in pairs with those of another.
    pub fn zip<U>(self, other: Dials<U>) -> Dials<(T, U)> {
        Dials {
            difficulty: (self.difficulty, other.difficulty),
            mapping: (self.mapping, other.mapping),
            navigation: (self.navigation, other.navigation),
        }
    }

    /// The dials by reference.
    pub fn as_ref(&self) -> Dials<&T> {
        Dials { difficulty: &self.difficulty, mapping: &self.mapping, navigation: &self.navigation }
    }

    /// The dials with their names, in order.
    pub fn named(self) -> [(&'static str, T); 3] {
        [
            ("difficulty", self.difficulty),
            ("mapping", self.mapping),
            ("navigation", self.navigation),
        ]
    }
}

/// A value with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

impl Estimate {
    /// The interval that holds the true value with a probability of 95 %, if errors are normal.
    pub fn interval(self) -> [f64; 2] {
        let half = 1.96 * self.standard_error;
        [self.value - half, self.value + half]
    }
}

/// What a calibration says of a world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prediction {
    /// Version of the calibration.
    pub calibration: u32,
    /// The dials, with standard errors.
    pub dials: Dials<Estimate>,
    /// Share of the features that lie outside what the atlas has. Those count as at its border: do not
    /// rely on the prediction of a world with many of them.
    pub outside: f64,
}
