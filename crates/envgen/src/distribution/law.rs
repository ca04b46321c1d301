//! Distributions of the caller, in place of those of a generator.

#[cfg(feature = "rand")]
use rand::distr::Distribution;

use crate::seed::Stream;

/// A continuous distribution of any type.
pub(crate) type Law<'a> = dyn Fn(&mut Stream) -> f64 + Send + Sync + 'a;

/// Converts a distribution into a [`Law`]. The drawing method of [`Distribution`] is generic, so that it cannot be
/// a trait object itself.
#[cfg(feature = "rand")]
pub(crate) fn law<'a>(distribution: impl Distribution<f64> + Send + Sync + 'a) -> Box<Law<'a>> {
    Box::new(move |stream| distribution.sample(stream))
}
