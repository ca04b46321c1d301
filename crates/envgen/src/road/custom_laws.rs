//! Roads drawn from laws of the caller.

#[cfg(feature = "rand")]
use rand::distr::Distribution;

use super::dirichlet::{Concentration, dirichlet};
use super::error::RoadError;
use crate::distribution::Law;
#[cfg(feature = "rand")]
use crate::distribution::law;
use crate::seed::Stream;

/// What replaces the laws of a [`RoadSpec`](super::RoadSpec) in `RoadSpec::generate_with_laws`.
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
    /// None: the spec's own laws.
    pub fn new() -> Self {
        RoadLaws::default()
    }

    /// The lengths of the segments: finite numbers of at least 0, drawn for one segment after the other,
    /// of which only the ratios count. They share out the `length` of the spec, or what `lengths` =
    /// `reserve` leaves of it. `alpha` is unused: its Dirichlet law is that of gamma variates of this
    /// shape.
    pub fn lengths(self, lengths: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        RoadLaws { lengths: Some(law(lengths)), ..self }
    }

    /// Where the radius of each turn lies between its least and its greatest, from 0 to 1; the angle, where
    /// `turn_law` of the spec is `uniform_angle`, and where the angles of a closed road are drawn again
    /// because they do not close it.
    pub fn turns(self, turns: impl Distribution<f64> + Send + Sync + 'a) -> Self {
        RoadLaws { turns: Some(law(turns)), ..self }
    }
}

impl RoadLaws<'_> {
    /// Whether there is any.
    pub(super) fn any(&self) -> bool {
        self.lengths.is_some() || self.turns.is_some()
    }

    /// The proportions of the lengths of `count` segments, which sum to 1.
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

    /// Where a turn lies between its limits, from 0 to 1; `None` where the spec's law says so.
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
