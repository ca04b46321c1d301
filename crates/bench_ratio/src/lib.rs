//! Benchmark ratios against a baseline that is measured in the same run. Machines are shared and
//! noisy, so absolute seconds say little.

use std::hint::black_box;
use std::time::Instant;

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
    let ratio = ours / baseline;
    let met = if ratio <= limit { "met" } else { "MISSED" };
    println!("{what}: {ratio:.2} x (target: at most {limit} x, {met})");
}

/// Prints how many times faster than the baseline ours is, and whether that is at least `limit`.
#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
pub fn faster(what: &str, (ours, baseline): (f64, f64), limit: f64) {
    let ratio = baseline / ours;
    let met = if ratio >= limit { "met" } else { "MISSED" };
    println!("{what}: {ratio:.1} x as fast (target: at least {limit} x, {met})");
}
