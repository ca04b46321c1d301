//! Ratios against a baseline that is measured in the same run: these machines are shared and noisy,
//! so that seconds alone say little.

use std::hint::black_box;
use std::time::Instant;

/// Rounds of a contest; the best of each side counts.
const ROUNDS: usize = 15;

/// Seconds of one call of each side, best of many rounds that take turns.
pub fn contest<A, B>(mut ours: impl FnMut() -> A, mut baseline: impl FnMut() -> B) -> (f64, f64) {
    (0..ROUNDS).fold((f64::INFINITY, f64::INFINITY), |best, _| {
        (best.0.min(seconds(&mut ours)), best.1.min(seconds(&mut baseline)))
    })
}

/// Seconds of one call.
#[expect(clippy::disallowed_methods, reason = "a benchmark looks at the clock")]
pub fn seconds<T>(mut work: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64()
}

/// Prints how many times the baseline's time ours takes, and whether that is at most `limit`.
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
