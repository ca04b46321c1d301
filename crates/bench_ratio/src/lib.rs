//! Benchmark ratios against a baseline that is measured in the same run. Machines are shared and
//! noisy, so absolute seconds say little.
//!
//! Results are lines that [`Ratio`] and [`Growth`] read back; `bench_report` makes a page of those of all benchmarks.

mod line;

use std::hint::black_box;
use std::time::Instant;

pub use line::{Bound, Growth, Ratio};

/// Number of rounds; the best of each side counts.
const ROUNDS: usize = 15;

/// Seconds per call of each side: the best of many alternating rounds.
pub fn contest<A, B>(mut ours: impl FnMut() -> A, mut baseline: impl FnMut() -> B) -> (f64, f64) {
    (0..ROUNDS).fold((f64::INFINITY, f64::INFINITY), |best, _| {
        (best.0.min(seconds(&mut ours)), best.1.min(seconds(&mut baseline)))
    })
}

/// Seconds per call.
#[expect(clippy::disallowed_methods, reason = "a benchmark needs the clock")]
pub fn seconds<T>(mut work: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

/// Prints the ratio of our time to the baseline's, and whether it is at most `limit`.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
pub fn at_most(what: &str, (ours, baseline): (f64, f64), limit: f64) {
    let what = what.to_owned();
    println!("{}", Ratio { what, ratio: ours / baseline, bound: Bound::AtMost(limit) });
}

/// Prints how many times faster than the baseline ours is, and whether that is at least `limit`.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
pub fn faster(what: &str, (ours, baseline): (f64, f64), limit: f64) {
    let what = what.to_owned();
    println!("{}", Ratio { what, ratio: baseline / ours, bound: Bound::AtLeast(limit) });
}

/// Prints how the cost grows with the size: the exponent of the power of the size that fits `(size, seconds)` best.
/// Prints nothing for fewer than two sizes.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
pub fn growth(what: &str, costs: &[(f64, f64)]) {
    if let Some(growth) = Growth::fit(what, costs) {
        println!("{growth}");
    }
}
