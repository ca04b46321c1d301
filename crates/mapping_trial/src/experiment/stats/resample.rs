//! The bootstrap over maps.

use envgen::Stream;
use serde::Serialize;
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
