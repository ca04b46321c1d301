//! The lines that benchmarks print, and their parsers.

use std::fmt;
use std::str::FromStr;

use crate::Times;

/// The bound of a ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// The upper limit of the ratio of our time to that of the baseline.
    AtMost(f64),
    /// The lower limit of how many times faster our side is than the baseline.
    AtLeast(f64),
}

/// A ratio of times, with its bound.
///
/// ```
/// use bench_ratio::{Bound, Ratio};
///
/// let times = [(1.6, 1.0), (1.5, 1.0)].into_iter().collect();
/// let ratio = Ratio::new("a ray: long", &times, Bound::AtMost(2.0));
/// let line = "a ray: long: 1.50 x (rounds: 1.50 to 1.60) (target: at most 2 x, met)";
/// assert_eq!(ratio.to_string(), line);
/// assert_eq!(ratio.to_string().parse(), Ok(ratio));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// What was measured, and the baseline.
    pub what: String,
    /// The ratio.
    pub ratio: f64,
    /// The least and the greatest ratio of a round, without the lowest and the highest quarter of the rounds,
    /// or `None` if each side was measured separately.
    pub spread: Option<(f64, f64)>,
    /// The bound of the ratio.
    pub bound: Bound,
}

impl Ratio {
    /// Computes the ratio of the best times of each side.
    pub fn new(what: &str, times: &Times, bound: Bound) -> Self {
        let value = |ours: f64, baseline: f64| match bound {
            Bound::AtMost(_) => ours / baseline,
            Bound::AtLeast(_) => baseline / ours,
        };
        Ratio {
            what: what.to_owned(),
            ratio: value(times.ours(), times.baseline()),
            spread: times.middle_half(value),
            bound,
        }
    }

    /// Returns whether the ratio is within its bound.
    pub fn is_met(&self) -> bool {
        match self.bound {
            Bound::AtMost(limit) => self.ratio <= limit,
            Bound::AtLeast(limit) => self.ratio >= limit,
        }
    }
}

/// The texts before the spread and the bound.
const ROUNDS: &str = " (rounds: ";
const TARGET: &str = " (target: ";

impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Ratio { what, ratio, spread, bound } = self;
        match bound {
            Bound::AtMost(_) => write!(f, "{what}: {ratio:.2} x")?,
            Bound::AtLeast(_) => write!(f, "{what}: {ratio:.1} x as fast")?,
        }
        if let Some((low, high)) = spread {
            write!(f, "{ROUNDS}{low:.2} to {high:.2})")?;
        }
        let met = if self.is_met() { "met" } else { "MISSED" };
        match bound {
            Bound::AtMost(limit) => write!(f, "{TARGET}at most {limit} x, {met})"),
            Bound::AtLeast(limit) => write!(f, "{TARGET}at least {limit} x, {met})"),
        }
    }
}

/// An error for a line that does not have the expected form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotALine;

impl FromStr for Ratio {
    type Err = NotALine;

    fn from_str(line: &str) -> Result<Self, NotALine> {
        let (start, target) = line.trim().rsplit_once(TARGET).ok_or(NotALine)?;
        let number = |text: &str| text.parse::<f64>().map_err(|_| NotALine);
        let (start, spread) = match start.rsplit_once(ROUNDS) {
            None => (start, None),
            Some((start, rounds)) => {
                let rounds = rounds.strip_suffix(')').and_then(|text| text.split_once(" to "));
                let (low, high) = rounds.ok_or(NotALine)?;
                (start, Some((number(low)?, number(high)?)))
            }
        };
        let (what, ratio) = start.rsplit_once(": ").ok_or(NotALine)?;
        let limit = |text: &str| number(text.split(' ').next().unwrap_or_default());
        let (ratio, bound) = if let Some(rest) = target.strip_prefix("at most ") {
            (ratio.strip_suffix(" x").ok_or(NotALine)?, Bound::AtMost(limit(rest)?))
        } else {
            let rest = target.strip_prefix("at least ").ok_or(NotALine)?;
            (ratio.strip_suffix(" x as fast").ok_or(NotALine)?, Bound::AtLeast(limit(rest)?))
        };
        Ok(Ratio { what: what.to_owned(), ratio: number(ratio)?, spread, bound })
    }
}

/// How a cost grows with a size.
///
/// ```
/// use bench_ratio::Growth;
///
/// let growth = Growth::fit("a sort", &[(1e3, 1.0), (1e4, 10.5), (1e5, 110.0)]).unwrap();
/// assert_eq!(growth.to_string(), "a sort: grows as size^1.02 from 1e3 to 1e5");
/// assert_eq!(growth.to_string().parse::<Growth>().unwrap().what, "a sort");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// What was measured.
    pub what: String,
    /// The exponent of the power law that fits best. It is 1 if the cost is proportional to the size.
    pub exponent: f64,
    /// The smallest and the largest size.
    pub sizes: (f64, f64),
}

impl Growth {
    /// Fits a line to the logarithms of `(size, seconds)` by least squares. Returns `None` for fewer than two
    /// sizes, or if a number is not above 0.
    pub fn fit(what: &str, costs: &[(f64, f64)]) -> Option<Self> {
        if costs.iter().any(|&(size, cost)| !(size > 0.0 && cost > 0.0)) {
            return None;
        }
        let logs = || costs.iter().map(|&(size, cost)| (libm::log(size), libm::log(cost)));
        let count = costs.len() as f64;
        let mean = |part: fn((f64, f64)) -> f64| logs().map(part).sum::<f64>() / count;
        let (x, y) = (mean(|log| log.0), mean(|log| log.1));
        let spread: f64 = logs().map(|log| (log.0 - x) * (log.0 - x)).sum();
        let slope: f64 = logs().map(|log| (log.0 - x) * (log.1 - y)).sum();
        let least = costs.iter().map(|cost| cost.0).fold(f64::INFINITY, f64::min);
        let most = costs.iter().map(|cost| cost.0).fold(0.0, f64::max);
        let (what, sizes) = (what.to_owned(), (least, most));
        (spread > 0.0).then(|| Growth { what, exponent: slope / spread, sizes })
    }
}

/// The text before the exponent.
const GROWS: &str = ": grows as size^";

impl fmt::Display for Growth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Growth { what, exponent, sizes: (from, to) } = self;
        write!(f, "{what}{GROWS}{exponent:.2} from {from:e} to {to:e}")
    }
}

impl FromStr for Growth {
    type Err = NotALine;

    fn from_str(line: &str) -> Result<Self, NotALine> {
        let (what, rest) = line.trim().rsplit_once(GROWS).ok_or(NotALine)?;
        let parts: Vec<&str> = rest.split(' ').collect();
        let [exponent, "from", from, "to", to] = parts[..] else { return Err(NotALine) };
        let number = |text: &str| text.parse::<f64>().map_err(|_| NotALine);
        let (exponent, sizes) = (number(exponent)?, (number(from)?, number(to)?));
        Ok(Growth { what: what.to_owned(), exponent, sizes })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn other_lines_are_not_taken_for_results() {
        for line in [
            "",
            "random filling at 8192^2: 3.20 ns a cell",
            "a: 2 x (target: at most many x, met)",
            "a: two x (target: at most 2 x, met)",
            "a: 2 x as fast (target: at most 2 x, met)",
            "(target: at most 2 x, met)",
        ] {
            assert_eq!(line.parse::<Ratio>(), Err(NotALine), "{line}");
        }
        assert_eq!("grows as size^2".parse::<Growth>(), Err(NotALine));
        assert_eq!("a: grows as size^2 from 1".parse::<Growth>(), Err(NotALine));
    }

    #[test]
    fn a_bound_is_met_where_it_is_reached() {
        let met = |ratio, bound| Ratio::new("", &(ratio, 1.0).into(), bound).is_met();
        assert!(met(2.0, Bound::AtMost(2.0)) && met(0.5, Bound::AtLeast(2.0)));
        assert!(!met(2.1, Bound::AtMost(2.0)) && !met(0.6, Bound::AtLeast(2.0)));
        assert!(!met(f64::NAN, Bound::AtMost(2.0)) && !met(f64::NAN, Bound::AtLeast(2.0)));
    }

    #[test]
    fn one_size_shows_no_growth() {
        assert_eq!(Growth::fit("a", &[(10.0, 1.0)]), None);
        assert_eq!(Growth::fit("a", &[(10.0, 1.0), (10.0, 2.0)]), None);
        assert_eq!(Growth::fit("a", &[(10.0, 1.0), (20.0, 0.0)]), None);
    }

    proptest! {
        #[test]
        fn what_was_printed_is_read(
            what in "[a-z0-9:(), ^]{0,30}", ratio in 0.0..1e4_f64, limit in 0.0..1e4_f64, is_most: bool,
            spread in proptest::option::of((0.0..1e4_f64, 0.0..1e4_f64)),
        ) {
            let bound = if is_most { Bound::AtMost(limit) } else { Bound::AtLeast(limit) };
            let what = what.trim().to_owned();
            let printed = Ratio { what, ratio, spread, bound };
            let read: Ratio = printed.to_string().parse().expect("a ratio");
            prop_assert_eq!((read.what, read.bound), (printed.what, bound));
            prop_assert!((read.ratio - ratio).abs() <= 0.051);
            let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs().max((a.1 - b.1).abs()) < 0.01;
            prop_assert!(read.spread.is_none() == spread.is_none());
            prop_assert!(read.spread.zip(spread).is_none_or(|(read, spread)| near(read, spread)));
        }

        #[test]
        fn a_power_is_found(exponent in -1.0..3.0_f64, scale in 1e-6..1.0_f64) {
            let costs = [10.0, 40.0, 100.0, 1e4].map(|size| (size, scale * libm::pow(size, exponent)));
            let found = Growth::fit("a power", &costs).expect("sizes");
            prop_assert!((found.exponent - exponent).abs() < 1e-9);
            let read: Growth = found.to_string().parse().expect("a growth");
            prop_assert_eq!((read.what.as_str(), read.sizes), ("a power", (10.0, 1e4)));
        }
    }
}
