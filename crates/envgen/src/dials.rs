//! The dials of difficulty, and predictions of their values.

use serde::{Deserialize, Serialize};

/// One value for each dial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dials<T> {
    /// The difficulty as a whole, `d`, from the score D.
    pub difficulty: T,
    /// The difficulty of mapping, `m`, from the score M.
    pub mapping: T,
    /// The difficulty of navigation, `n`, from the score N.
    pub navigation: T,
}

impl<T> Dials<T> {
    /// Applies a function to the value of each dial.
    pub fn map<U>(self, mut to: impl FnMut(T) -> U) -> Dials<U> {
        Dials {
            difficulty: to(self.difficulty),
            mapping: to(self.mapping),
            navigation: to(self.navigation),
        }
    }

    /// Returns the dials, each paired with the same dial of `other`.
    pub fn zip<U>(self, other: Dials<U>) -> Dials<(T, U)> {
        Dials {
            difficulty: (self.difficulty, other.difficulty),
            mapping: (self.mapping, other.mapping),
            navigation: (self.navigation, other.navigation),
        }
    }

    /// Returns the dials as references.
    pub fn as_ref(&self) -> Dials<&T> {
        Dials { difficulty: &self.difficulty, mapping: &self.mapping, navigation: &self.navigation }
    }

    /// Returns the dials with their names, in order.
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
    /// Returns the interval that contains the true value with a probability of 95 %, if errors are normally
    /// distributed.
    pub fn interval(self) -> [f64; 2] {
        let half = 1.96 * self.standard_error;
        [self.value - half, self.value + half]
    }
}

/// The difficulty that a calibration predicts for a world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prediction {
    /// Version of the calibration.
    pub calibration: u32,
    /// The predicted dials, with their standard errors.
    pub dials: Dials<Estimate>,
    /// Share of the features that lie outside the range of the atlas. Such features count as if they were at its
    /// border, so the prediction of a world with many of them is not reliable.
    pub outside: f64,
}

impl Prediction {
    /// Greatest share of features outside the range of the atlas for which a prediction is used.
    pub const MOST_OUTSIDE: f64 = 0.1;

    /// Returns whether the world is so unlike those of the atlas that the prediction is not reliable.
    pub fn is_extrapolated(&self) -> bool {
        self.outside > Prediction::MOST_OUTSIDE
    }

    /// Returns the mean of the prediction and of that of another calibration, whose version it has. `share` is the
    /// weight of the other, from 0 to 1.
    pub(crate) fn mixed(&self, other: &Prediction, share: f64) -> Prediction {
        let between = |own: f64, other: f64| own + share * (other - own);
        let dials = self.dials.zip(other.dials).map(|(own, other)| Estimate {
            value: between(own.value, other.value),
            standard_error: between(own.standard_error, other.standard_error),
        });
        let outside = between(self.outside, other.outside);
        Prediction { calibration: other.calibration, dials, outside }
    }
}
