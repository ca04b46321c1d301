//! Agreement of measured difficulties with requested ones.

use envgen::{Seed, Stream};
use serde::Serialize;

use crate::difficulty::NEAR_REQUEST;
use crate::experiment::stats::{Interval, bootstrap, fraction, spearman};
use crate::score::kendall_tau;

/// How well measured values agree with requested ones, over maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Number of maps, which is 0 for lists of different lengths.
    pub maps: usize,
    /// Spearman's rank correlation.
    pub rho: Option<Interval>,
    /// Kendall's tau-b.
    pub tau: Option<Interval>,
    /// Mean absolute difference.
    pub error: Option<Interval>,
    /// Slope of the line through the measured values over the requested ones.
    pub slope: Option<Interval>,
    /// Value of this line at 0.
    pub intercept: Option<Interval>,
    /// Fraction of the maps whose measured value is [near](NEAR_REQUEST) the requested one. Its interval contains the
    /// exact one of a fraction, because the bootstrap has none if all maps are near, or none is.
    pub near: Option<Interval>,
}

/// Compares values map by map, with 95 % intervals by the bootstrap over maps, which are too narrow for a
/// few maps. Nothing is known for lists of different lengths, without maps, or if a value is not finite.
///
/// ```
/// use mapping_trial::difficulty::proof::agreement;
///
/// let found = agreement(&[1.0, 3.0, 5.0, 7.0], &[1.5, 3.5, 5.5, 7.5]);
/// assert_eq!(found.error.map(|error| error.value), Some(0.5));
/// assert_eq!(agreement(&[], &[]).error, None);
/// ```
pub fn agreement(requested: &[f64], measured: &[f64]) -> Agreement {
    if requested.len() != measured.len() {
        return Agreement::new(0, [None; 6]);
    }
    let mut stream: Stream = Seed(0).stream("proof/bootstrap", 0);
    let found = bootstrap(&vec![0; requested.len()], &mut stream, |drawn| {
        statistics(&pick(requested, drawn), &pick(measured, drawn))
    });
    Agreement::new(requested.len(), found)
}

/// Does the same for scores of another panel, which are linked by the scores of other maps under the
/// reference panel and under the other one. `dial` converts a score of the reference panel to a
/// difficulty. The bootstrap also draws the maps of the link and fits it again, so that the intervals
/// include its error. Returns `None` without a link, or for lists of different lengths.
pub(super) fn linked_agreement(
    (requested, scores): (&[f64], &[f64]),
    (reference, other): (&[f64], &[f64]),
    dial: impl Fn(f64) -> f64,
) -> Option<Agreement> {
    Link::new(reference, other)?;
    if requested.len() != scores.len() {
        return None;
    }
    let (tested, linking) = (requested.len(), other.len());
    let groups: Vec<usize> = [0].repeat(tested).into_iter().chain([1].repeat(linking)).collect();
    let mut stream: Stream = Seed(0).stream("proof/bootstrap", 0);
    let found = bootstrap(&groups, &mut stream, |drawn| {
        let (drawn, of_link) = drawn.split_at(tested);
        let of_link: Vec<usize> = of_link.iter().map(|i| i - tested).collect();
        let link = Link::new(&pick(reference, &of_link), &pick(other, &of_link));
        link.map_or([None; 6], |link| {
            let measured: Vec<f64> = drawn.iter().map(|&i| dial(link.apply(scores[i]))).collect();
            statistics(&pick(requested, drawn), &measured)
        })
    });
    Some(Agreement::new(tested, found))
}

fn pick(values: &[f64], drawn: &[usize]) -> Vec<f64> {
    drawn.iter().map(|&i| values[i]).collect()
}

/// Returns the statistics in the order of [`Agreement`]; none without maps, or if a value is not finite.
fn statistics(x: &[f64], y: &[f64]) -> [Option<f64>; 6] {
    if x.is_empty() || !x.iter().chain(y).all(|value| value.is_finite()) {
        return [None; 6];
    }
    let line = line(x, y);
    let n = x.len() as f64;
    let errors = || x.iter().zip(y).map(|(x, y)| (x - y).abs());
    let error = errors().sum::<f64>() / n;
    let near = errors().filter(|error| *error <= NEAR_REQUEST).count() as f64 / n;
    [
        spearman(x, y),
        kendall_tau(x, y),
        Some(error),
        line.map(|(slope, _)| slope),
        line.map(|(_, intercept)| intercept),
        Some(near),
    ]
}

impl Agreement {
    fn new(maps: usize, found: [Option<Interval>; 6]) -> Self {
        let [rho, tau, error, slope, intercept, near] = found;
        let near =
            near.map(|near| match fraction((near.value * maps as f64).round() as usize, maps) {
                Some(exact) => Interval {
                    low: near.low.min(exact.low),
                    high: near.high.max(exact.high),
                    ..near
                },
                None => near,
            });
        Agreement { maps, rho, tau, error, slope, intercept, near }
    }
}

/// Returns slope and intercept of the least-squares line; `None` if `x` does not vary.
fn line(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let n = x.len() as f64;
    let (x_mean, y_mean) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xx: f64 = x.iter().map(|x| (x - x_mean) * (x - x_mean)).sum();
    let xy: f64 = x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    (xx > 0.0).then(|| (xy / xx, y_mean - xy / xx * x_mean))
}

/// A linear link from values under other conditions to those of the reference panel: both have the same
/// mean and the same deviation over the maps that both have measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Link {
    /// Change of the reference value per unit of the other value.
    pub slope: f64,
    /// Reference value for 0 of the other value.
    pub intercept: f64,
    /// Number of maps.
    pub maps: usize,
}

impl Link {
    /// Computes the link from paired values; `None` if the other values do not vary, for lists of
    /// different lengths, or if a value is not finite.
    pub fn new(reference: &[f64], other: &[f64]) -> Option<Self> {
        if reference.len() != other.len() {
            return None;
        }
        let n = other.len() as f64;
        let moments = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
            (mean, variance.sqrt())
        };
        let ((mean, deviation), (other_mean, other_deviation)) =
            (moments(reference), moments(other));
        // Equal values deviate by rounding.
        let varies = other_deviation > 1e-9 * other_mean.abs();
        let slope = deviation / other_deviation;
        let link = Link { slope, intercept: mean - slope * other_mean, maps: other.len() };
        (varies && link.slope.is_finite() && link.intercept.is_finite()).then_some(link)
    }

    /// Converts a value to the reference's scale.
    pub fn apply(&self, value: f64) -> f64 {
        self.intercept + self.slope * value
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn agreement_by_hand() {
        let requested: Vec<f64> = (0..40).map(f64::from).collect();
        let measured: Vec<f64> = requested.iter().map(|x| 0.5 * x + 3.0).collect();
        let found = agreement(&requested, &measured);
        let value = |interval: Option<Interval>| interval.expect("an interval").value;
        assert_eq!((value(found.rho), value(found.tau)), (1.0, 1.0));
        assert!((value(found.slope) - 0.5).abs() < 1e-12);
        assert!((value(found.intercept) - 3.0).abs() < 1e-9);
        let error: f64 = requested.iter().map(|x| (0.5 * x - 3.0).abs()).sum::<f64>() / 40.0;
        assert!((value(found.error) - error).abs() < 1e-12);
        // At 5, 6 and 7, of which the line has 5.5, 6 and 6.5.
        assert_eq!(value(found.near), 3.0 / 40.0);
        // The bootstrap alone would be certain.
        let near = agreement(&requested, &requested).near.expect("an interval");
        assert_eq!((near.value, near.high), (1.0, 1.0));
        assert!((near.low - 0.9119).abs() < 1e-4, "{near:?}");
    }

    #[test]
    fn nothing_agrees_without_pairs_of_numbers() {
        let nothing = |maps| Agreement::new(maps, [None; 6]);
        assert_eq!(agreement(&[], &[]), nothing(0));
        for (a, b) in [(&[1.0, 2.0, 3.0][..], &[1.0, 2.0][..]), (&[][..], &[1.0][..])] {
            assert_eq!((agreement(a, b), agreement(b, a)), (nothing(0), nothing(0)));
            assert_eq!((Link::new(a, b), Link::new(b, a)), (None, None));
            let same = (&[1.0, 2.0][..], &[3.0, 5.0][..]);
            assert_eq!(linked_agreement((a, b), same, |x| x), None);
            assert_eq!(linked_agreement(same, (a, b), |x| x), None);
        }
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (good, bad) = ([1.0, 2.0, 4.0], [1.0, wrong, 4.0]);
            assert_eq!((agreement(&good, &bad), agreement(&bad, &good)), (nothing(3), nothing(3)));
            assert_eq!((Link::new(&good, &bad), Link::new(&bad, &good)), (None, None));
        }
    }

    proptest! {
        #[test]
        fn links_are_numbers(
            a in prop::collection::vec(prop_oneof![any::<f64>(), -9.0..9.0_f64], 0..9),
            b in prop::collection::vec(prop_oneof![any::<f64>(), -9.0..9.0_f64], 0..9),
        ) {
            if let Some(link) = Link::new(&a, &b) {
                prop_assert!(link.slope.is_finite() && link.intercept.is_finite(), "{:?}", link);
                prop_assert_eq!((a.len(), b.len()), (link.maps, link.maps));
            }
        }
    }

    #[test]
    fn intervals_of_linked_values_hold_the_error_of_the_link() {
        let requested: Vec<f64> = (0..60).map(|i| f64::from(i) / 6.0).collect();
        let scores: Vec<f64> = requested.iter().map(|x| 2.0 * x + 1.0).collect();
        // Maps that link with errors of up to 1 on both sides.
        let reference: Vec<f64> = (0..12).map(|i| f64::from(i) * 0.8).collect();
        let error = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let other: Vec<f64> =
            reference.iter().enumerate().map(|(i, x)| 2.0 * (x + error(i)) + 1.0).collect();
        let found = linked_agreement((&requested, &scores), (&reference, &other), |x| x);
        let found = found.expect("a link");
        let link = Link::new(&reference, &other).expect("a link");
        let linked: Vec<f64> = scores.iter().map(|&score| link.apply(score)).collect();
        let alone = agreement(&requested, &linked);
        let width = |interval: Option<Interval>| {
            let Interval { value, low, high } = interval.expect("an interval");
            (value, high - low)
        };
        // The line is exact but for the link.
        let (slope, wide) = width(found.slope);
        assert_eq!(slope, width(alone.slope).0);
        assert!(width(alone.slope).1 < 1e-9 && (0.05..0.6).contains(&wide), "{wide}");
        assert_eq!(width(found.rho), width(alone.rho));
        assert!(linked_agreement((&requested, &scores), (&[1.0], &[2.0]), |x| x).is_none());
    }

    #[test]
    fn linked_values_have_the_mean_and_deviation_of_the_reference() {
        let reference = [1.0, 2.0, 6.0];
        let other: Vec<f64> = reference.iter().map(|x| 7.0 - 2.0 * (x - 3.0)).collect();
        let link = Link::new(&reference, &other).expect("a link");
        assert!((link.slope - 0.5).abs() < 1e-12 && link.maps == 3);
        assert!((link.apply(7.0) - 3.0).abs() < 1e-12);
        assert_eq!(Link::new(&reference, &[6.1; 3]), None);
    }
}
