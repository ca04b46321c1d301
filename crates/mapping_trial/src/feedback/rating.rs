//! Ratings from 0 to 10.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

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
    /// Returns the rating as a number.
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
