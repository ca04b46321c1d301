//! Benchmarks as ratios to a baseline that is measured in the same run, since absolute times mean little on
//! machines that are shared and noisy.
//!
//! Results are printed as lines, which [`Ratio`] and [`Growth`] can parse. The program `bench_report` makes a
//! page from the lines of all benchmarks.

mod line;
mod times;

use std::hint::black_box;
use std::time::Instant;

pub use line::{Bound, Growth, Ratio};
pub use times::Times;

/// The number of rounds of [`contest`].
const ROUNDS: usize = 15;

/// Measures the seconds per call of both sides, in many alternating rounds.
pub fn contest<A, B>(ours: impl FnMut() -> A, baseline: impl FnMut() -> B) -> Times {
    rounds(ROUNDS, ours, baseline)
}

/// Measures the seconds per call of both sides, in `count` alternating rounds.
pub fn rounds<A, B>(
    count: usize,
    mut ours: impl FnMut() -> A,
    mut baseline: impl FnMut() -> B,
) -> Times {
    (0..count).map(|_| (seconds(&mut ours), seconds(&mut baseline))).collect()
}

/// Measures the seconds of a call.
#[expect(clippy::disallowed_methods, reason = "a benchmark needs the clock")]
pub fn seconds<T>(mut work: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

/// Prints the ratio of our time to that of the baseline, its spread, and whether it is at most `limit`.
pub fn at_most(what: &str, times: impl Into<Times>, limit: f64) {
    say(what, &times.into(), Bound::AtMost(limit));
}

/// Prints how many times faster our side is than the baseline, the spread, and whether this is at least
/// `limit`.
pub fn faster(what: &str, times: impl Into<Times>, limit: f64) {
    say(what, &times.into(), Bound::AtLeast(limit));
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn say(what: &str, times: &Times, bound: Bound) {
    println!("{}", Ratio::new(what, times, bound));
}

/// Prints how the cost grows with the size: the exponent of the power law that fits `(size, seconds)` best.
/// Prints nothing for fewer than two sizes.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
pub fn growth(what: &str, costs: &[(f64, f64)]) {
    if let Some(growth) = Growth::fit(what, costs) {
        println!("{growth}");
    }
}
