//! Roads drawn from distributions of the caller.

#[cfg(feature = "rand")]
use rand::distr::Distribution;

use super::dirichlet::{Concentration, dirichlet};
use super::error::RoadError;
use crate::distribution::Law;
#[cfg(feature = "rand")]
use crate::distribution::law;
use crate::seed::Stream;

/// Distributions that replace those of a [`RoadSpec`](super::RoadSpec) in `RoadSpec::generate_with_laws`.
///
/// ```
/// use envgen::Seed;
/// use envgen::road::{RoadLaws, RoadSpec};
/// use rand_distr::{Beta, LogNormal};
///
/// // A few long segments among many short ones, and hardly any turn as wide or as tight as allowed.
/// let laws = RoadLaws::new().lengths(LogNormal::new(0.0, 1.0)?).turns(Beta::new(3.0, 3.0)?);
/// let road = RoadSpec::default().generate_with_laws(Seed(1), &laws)?;
/// assert!(road.edited());
/// assert_eq!(road.segments().iter().map(|segment| segment.length).sum::<f64>(), 1000.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
#[cfg_attr(
    not(feature = "rand"),
    expect(unreachable_pub, reason = "it is public with the feature `rand`")
)]
pub struct RoadLaws<'a> {
    lengths: Option<Box<Law<'a>>>,
    turns: Option<Box<Law<'a>>>,
}

#[cfg(feature = "rand")]
impl<'a> RoadLaws<'a> {
    /// Creates a set without distributions, which keeps those of the spec.
    pub fn new() -> Self {
        RoadLaws::default()
    }

    /// Sets the distribution of the segments' lengths: finite numbers of at least 0, drawn for one segment after
    /// the other. Only their ratios count. They divide the `length` of the spec, or the rest of it that `lengths` =
    /// `reserve` leaves. The spec's `alpha` is then unused: its Dirichlet distribution is that of gamma variates of
    /// this shape.
    pub fn lengths(self, lengths: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        RoadLaws { lengths: Some(law(lengths)), ..self }
    }

    /// Sets the distribution of the turns: numbers from 0 to 1 that place the radius of each turn between its least
    /// and its greatest value. They place the angle instead where `turn_law` of the spec is `uniform_angle`, and
    /// where the angles of a closed road are drawn again because they do not close it.
    pub fn turns(self, turns: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        RoadLaws { turns: Some(law(turns)), ..self }
    }
}

impl RoadLaws<'_> {
    /// Whether there is any distribution.
    pub(super) fn any(&self) -> bool {
        self.lengths.is_some() || self.turns.is_some()
    }

    /// Draws the proportions of the lengths of `count` segments, which sum to 1.
    pub(super) fn proportions(
        &self,
        alpha: &Concentration,
        count: usize,
        stream: &mut Stream,
    ) -> Result<Vec<f64>, RoadError> {
        let Some(law) = &self.lengths else {
            return Ok(dirichlet(alpha, count, stream));
        };
        let draw = |segment| {
            let value = law(stream);
            let is_allowed = (0.0..f64::INFINITY).contains(&value);
            if is_allowed { Ok(value) } else { Err(RoadError::LengthLaw { segment, value }) }
        };
        let mut shares: Vec<f64> = (1..=count).map(draw).collect::<Result<_, RoadError>>()?;
        let greatest = shares.iter().copied().fold(0.0, f64::max);
        if greatest == 0.0 {
            return Err(RoadError::NoLengths { segments: count });
        }
        // Relative to the greatest first, as the sum of very great numbers would be infinite.
        shares.iter_mut().for_each(|share| *share /= greatest);
        let total: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= total);
        Ok(shares)
    }

    /// Draws the position of a turn between its limits, from 0 to 1; `None` if the spec's distribution applies.
    pub(super) fn turn_share(
        &self,
        segment: usize,
        stream: &mut Stream,
    ) -> Result<Option<f64>, RoadError> {
        let Some(law) = &self.turns else { return Ok(None) };
        let value = law(stream);
        if (0.0..=1.0).contains(&value) {
            Ok(Some(value))
        } else {
            Err(RoadError::TurnLaw { segment, value })
        }
    }
}
