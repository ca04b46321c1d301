//! Distributions that are truncated at two limits.

use rand::Rng;
use rand::distr::Distribution;

use crate::error::SpecError;

/// A distribution under the condition that the value lies between two limits. Values outside are drawn again.
///
/// Generators refuse values that are out of their range; this type keeps an unbounded distribution, such as the
/// normal or the log-normal one, within it. After [`Truncated::MAX_DRAWS`] values outside the limits, the last of
/// them is the result, and the generator names it in its error.
///
/// ```
/// use envgen::{Seed, distribution::Truncated};
/// use rand_distr::{Distribution, Normal};
///
/// let law = Truncated::new(Normal::new(1.0, 0.5)?, 0.2, 2.0)?;
/// let mut stream = Seed(1).stream("example", 0);
/// assert!((0..1000).all(|_| (0.2..=2.0).contains(&law.sample(&mut stream))));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncated<D> {
    law: D,
    min: f64,
    max: f64,
}

impl<D> Truncated<D> {
    /// The greatest number of values that are drawn for one result. A distribution with a thousandth of its
    /// probability between the limits misses them with all draws in 5 of 100,000 cases.
    pub const MAX_DRAWS: u32 = 10_000;

    /// Creates the distribution between `min` and `max`, limits included. An infinite limit means no limit.
    ///
    /// # Errors
    /// When a limit is NaN, or `min` is greater than `max`.
    pub fn new(law: D, min: f64, max: f64) -> Result<Self, SpecError> {
        if max.is_nan() {
            return Err(SpecError::new("max", max, "a number"));
        }
        // False for NaN.
        if min <= max {
            return Ok(Truncated { law, min, max });
        }
        Err(SpecError::new("min", min, format!("a number of at most {max}, which is `max`")))
    }
}

impl<D: Distribution<f64>> Distribution<f64> for Truncated<D> {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        let mut value = self.law.sample(rng);
        for _ in 1..Self::MAX_DRAWS {
            if (self.min..=self.max).contains(&value) {
                break;
            }
            value = self.law.sample(rng);
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use proptest::prelude::*;

    #[test]
    fn limits_that_are_none_are_refused() {
        let error = |min, max| Truncated::new((), min, max).unwrap_err().to_string();
        assert_eq!(error(2.0, 1.0), "`min` must be a number of at most 1, which is `max`, got 2");
        assert_eq!(
            error(f64::NAN, 1.0),
            "`min` must be a number of at most 1, which is `max`, got NaN"
        );
        assert_eq!(error(0.0, f64::NAN), "`max` must be a number, got NaN");
        assert!(Truncated::new((), f64::NEG_INFINITY, f64::INFINITY).is_ok());
    }

    #[test]
    fn a_law_outside_of_the_limits_comes_to_an_end() {
        let mut stream = Seed(1).stream("test", 0);
        let beyond = rand_distr::Uniform::new(5.0, 6.0).unwrap();
        let value = Truncated::new(beyond, 0.0, 1.0).unwrap().sample(&mut stream);
        assert!((5.0..6.0).contains(&value));
        let none = Truncated::new(beyond.map(|_| f64::NAN), 0.0, 1.0).unwrap();
        assert!(none.sample(&mut stream).is_nan());
    }

    proptest! {
        #[test]
        fn values_lie_between_the_limits(
            seed: u64, mean in -5.0..5.0_f64, deviation in 0.1..10.0_f64, min in -5.0..5.0_f64,
        ) {
            let normal = rand_distr::Normal::new(mean, deviation).unwrap();
            let law = Truncated::new(normal, min, f64::INFINITY).unwrap();
            let value = law.sample(&mut Seed(seed).stream("test", 0));
            // The limit is up to 100 deviations away: then the value is outside.
            prop_assert!(value >= min || (min - mean) / deviation > 2.0);
        }
    }
}
