//! Forests, roads and indoor maps from laws of the caller. Seeds are fixed; each test of a law has a
//! false-alarm rate of 1e-4.

mod forests;
mod indoor;
mod roads;

use proptest::prelude::*;
use rand::Rng;
use rand_distr::Distribution;
use statrs::stats_tests::NaNPolicy;
use statrs::stats_tests::ks_test::{KSTwoSampleAlternativeMethod, ks_twosample};

/// A law of one value.
struct Constant(f64);

impl Distribution<f64> for Constant {
    fn sample<R: Rng + ?Sized>(&self, _: &mut R) -> f64 {
        self.0
    }
}

/// Numbers that have broken programs before, and ordinary ones.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), proptest::num::f64::ANY, -1.0..4.0_f64, Just(0.0), Just(-0.0)]
}

/// Panics unless Kolmogorov and Smirnov's test finds one law in two samples of a continuous law.
#[track_caller]
fn assert_same_law(ours: Vec<f64>, theirs: Vec<f64>) {
    assert!(ours.len().min(theirs.len()) > 2000, "{} and {}", ours.len(), theirs.len());
    let method = KSTwoSampleAlternativeMethod::TwoSidedAsymptotic;
    let (_, p) = ks_twosample(ours, theirs, method, NaNPolicy::Error).unwrap();
    assert!(p > 1e-4, "p = {p}");
}
