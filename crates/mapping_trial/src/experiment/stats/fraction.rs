//! Fractions with exact intervals.

use statrs::distribution::{Beta, ContinuousCDF};

use super::resample::Interval;

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

#[cfg(test)]
mod tests {
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
}
