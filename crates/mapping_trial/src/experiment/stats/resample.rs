//! The bootstrap over maps.

use envgen::Stream;
use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};
use statrs::statistics::{Data, OrderStatistics};

/// Number of samples of every bootstrap.
pub const RESAMPLES: usize = 2000;

/// An estimate with its 95 % interval.
///
/// ```
/// use mapping_trial::experiment::stats::Interval;
///
/// let clear = Interval { value: 0.4, low: 0.1, high: 0.7 };
/// assert!(clear.is_positive() && !clear.is_negative());
/// // An interval around 0 is neither.
/// let unclear = Interval { low: -0.1, ..clear };
/// assert!(!unclear.is_positive() && !unclear.is_negative());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Returns whether the whole interval is above 0.
    pub fn is_positive(&self) -> bool {
        self.low > 0.0
    }

    /// Returns whether the whole interval is below 0.
    pub fn is_negative(&self) -> bool {
        self.high < 0.0
    }
}

/// Returns the fraction of `some` among `all`, with its exact 95 % interval (Clopper and Pearson 1934); `None` if there
/// are none, or more of the former.
pub(crate) fn fraction(some: usize, all: usize) -> Option<Interval> {
    let others = all.checked_sub(some).filter(|_| all > 0)?;
    let (k, rest) = (some as f64, others as f64);
    let quantile = |a: f64, b: f64, level: f64| Some(Beta::new(a, b).ok()?.inverse_cdf(level));
    let low = if some > 0 { quantile(k, rest + 1.0, 0.025)? } else { 0.0 };
    let high = if others > 0 { quantile(k + 1.0, rest, 0.975)? } else { 1.0 };
    Some(Interval { value: k / all as f64, low, high })
}

/// Draws maps within their levels, as many as there are.
///
/// `levels` holds the level of each map, with the maps of a level together. The result lists indices of
/// maps in the order of their levels.
fn draw(levels: &[usize], stream: &mut Stream) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(levels.len());
    for group in levels.chunk_by(|a, b| a == b) {
        let first = drawn.len();
        drawn.extend(group.iter().map(|_| first + stream.below(group.len() as u64) as usize));
    }
    drawn
}

/// Computes the percentile bootstrap of several statistics of the same maps at once; `None` for those
/// that do not exist for the maps themselves, or for more than a tenth of the samples.
pub(crate) fn bootstrap<const N: usize>(
    levels: &[usize],
    stream: &mut Stream,
    statistics: impl Fn(&[usize]) -> [Option<f64>; N],
) -> [Option<Interval>; N] {
    let all: Vec<usize> = (0..levels.len()).collect();
    let values = statistics(&all);
    let mut samples: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(RESAMPLES));
    for _ in 0..RESAMPLES {
        let found = statistics(&draw(levels, stream));
        for (samples, value) in samples.iter_mut().zip(found) {
            samples.extend(value);
        }
    }
    let mut samples = samples.into_iter();
    values.map(|value| {
        let samples = samples.next().unwrap_or_default();
        if samples.len() < RESAMPLES * 9 / 10 {
            return None;
        }
        let mut samples = Data::new(samples);
        let (low, high) = (samples.quantile(0.025), samples.quantile(0.975));
        value.map(|value| Interval { value, low, high })
    })
}

#[cfg(test)]
mod tests {
    use envgen::Seed;

    use super::*;

    #[test]
    fn exact_intervals_of_fractions() {
        // Newcombe, Statistics in Medicine 17 (1998), table I: Clopper-Pearson.
        for (some, all, low, high) in [
            (81, 263, 0.2527, 0.3676),
            (15, 148, 0.0578, 0.1617),
            (0, 20, 0.0, 0.1684),
            (1, 29, 0.0009, 0.1776),
            (40, 40, 0.9119, 1.0),
        ] {
            let found = fraction(some, all).expect("an interval");
            assert_eq!(found.value, some as f64 / all as f64);
            let ends = [found.low - low, found.high - high];
            assert!(ends.iter().all(|off| off.abs() < 6e-5), "{some} of {all}: {found:?}");
        }
        assert_eq!((fraction(0, 0), fraction(3, 2)), (None, None));
    }

    #[test]
    fn draws_stay_within_levels() {
        let levels = [0, 0, 0, 1, 1, 2];
        let mut stream = Seed(1).stream("test", 0);
        let mut seen = [false; 6];
        for _ in 0..200 {
            let drawn = draw(&levels, &mut stream);
            assert_eq!(drawn.len(), levels.len());
            for (place, &map) in drawn.iter().enumerate() {
                assert_eq!(levels[place], levels[map]);
                seen[map] = true;
            }
        }
        assert_eq!(seen, [true; 6]);
    }

    #[test]
    fn an_interval_covers_the_mean_as_often_as_it_says() {
        // Means of 40 uniform numbers: the interval of 95 % misses 0.5 in about 6 % of cases, since
        // a bootstrap of 40 is a little narrow. More than 30 misses of 200 have probability < 1e-5.
        let mut misses = 0;
        for case in 0..200 {
            let mut stream = Seed(case).stream("test", 1);
            let values: Vec<f64> = (0..40).map(|_| stream.unit()).collect();
            let mean = |drawn: &[usize]| {
                [Some(drawn.iter().map(|&i| values[i]).sum::<f64>() / drawn.len() as f64)]
            };
            let [found] = bootstrap(&[0; 40], &mut stream, mean);
            let found = found.expect("a mean");
            assert!(found.low < found.value && found.value < found.high);
            misses += u32::from(!(found.low..=found.high).contains(&0.5));
        }
        assert!((2..=30).contains(&misses), "{misses}");
    }

    #[test]
    fn what_samples_do_not_have_is_absent() {
        let mut stream = Seed(1).stream("test", 2);
        let found = bootstrap(&[0, 0, 1, 1], &mut stream, |_| [None, Some(1.0)]);
        assert_eq!(found, [None, Some(Interval { value: 1.0, low: 1.0, high: 1.0 })]);
    }
}
