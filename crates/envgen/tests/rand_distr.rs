//! The crate's own laws against those of `rand_distr`, an independent implementation, and `rand`'s
//! methods on a `Stream`. Seeds are fixed; each sample pair has a false-alarm rate of 1e-4.

use envgen::distribution::{ln_gamma_variate, poisson, standard_normal};
use envgen::road::{Concentration, dirichlet};
use envgen::{Seed, Stream};
use rand::RngExt;
use rand::rand_core::Rng;
use rand::seq::{IndexedRandom, SliceRandom};
use rand_distr::multi::Dirichlet;
use rand_distr::{Beta, Distribution, Gamma, Poisson, StandardNormal, StandardUniform, Uniform};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::stats_tests::NaNPolicy;
use statrs::stats_tests::ks_test::{KSTwoSampleAlternativeMethod, ks_twosample};

const FALSE_ALARM: f64 = 1e-4;

/// The size of a sample.
const DRAWS: usize = 50_000;

/// Draws of a law, each sample on a stream of its own.
fn sample<T>(name: &str, case: usize, mut draw: impl FnMut(&mut Stream) -> T) -> Vec<T> {
    let mut stream = Seed(17).stream(name, case as u64);
    (0..DRAWS).map(|_| draw(&mut stream)).collect()
}

/// The p-value of Kolmogorov and Smirnov's test that two samples of a continuous law have one law.
fn same_continuous(ours: Vec<f64>, theirs: Vec<f64>) -> f64 {
    let method = KSTwoSampleAlternativeMethod::TwoSidedAsymptotic;
    ks_twosample(ours, theirs, method, NaNPolicy::Error).unwrap().1
}

/// The p-value of the chi-square test that two samples of equal size of whole numbers have one law.
/// Neighbours are joined until each bin holds ten of both together.
fn same_counts(ours: &[u64], theirs: &[u64]) -> f64 {
    let low = *ours.iter().chain(theirs).min().unwrap();
    let high = *ours.iter().chain(theirs).max().unwrap();
    let mut bins = vec![[0.0; 2]; (high - low + 1) as usize];
    for (which, sample) in [ours, theirs].into_iter().enumerate() {
        for &count in sample {
            bins[(count - low) as usize][which] += 1.0;
        }
    }
    let mut joined: Vec<[f64; 2]> = Vec::new();
    let mut open = [0.0; 2];
    for [a, b] in bins {
        open = [open[0] + a, open[1] + b];
        if open[0] + open[1] >= 10.0 {
            joined.push(open);
            open = [0.0; 2];
        }
    }
    let last = joined.last_mut().expect("the samples are large");
    *last = [last[0] + open[0], last[1] + open[1]];
    if joined.len() == 1 {
        return 1.0;
    }
    let chi2: f64 = joined.iter().map(|[a, b]| (a - b) * (a - b) / (a + b)).sum();
    1.0 - ChiSquared::new((joined.len() - 1) as f64).unwrap().cdf(chi2)
}

#[test]
fn uniform_numbers_are_rands() {
    let theirs = sample("theirs", 0, |stream| StandardUniform.sample(stream));
    let p = same_continuous(sample("ours", 0, Stream::unit), theirs);
    assert!(p > FALSE_ALARM, "unit: p = {p}");

    let law = Uniform::new(-3.0, 11.0).unwrap();
    let theirs = sample("theirs", 1, |stream| law.sample(stream));
    let p = same_continuous(sample("ours", 1, |stream| stream.between(-3.0, 11.0)), theirs);
    assert!(p > FALSE_ALARM, "between: p = {p}");

    let theirs = sample("theirs", 2, |stream| stream.random_range(0..37_u64));
    let p = same_counts(&sample("ours", 2, |stream| stream.below(37)), &theirs);
    assert!(p > FALSE_ALARM, "below: p = {p}");
}

#[test]
fn normal_numbers_are_rand_distrs() {
    let theirs = sample("theirs", 0, |stream| StandardNormal.sample(stream));
    let p = same_continuous(sample("ours", 0, standard_normal), theirs);
    assert!(p > FALSE_ALARM, "p = {p}");
}

#[test]
fn gamma_variates_are_rand_distrs() {
    for (case, shape) in [0.05, 0.3, 1.0, 2.5, 40.0, 1e4].into_iter().enumerate() {
        let law = Gamma::new(shape, 1.0).unwrap();
        let ours = sample("ours", case, |stream| libm::exp(ln_gamma_variate(stream, shape)));
        let p = same_continuous(ours, sample("theirs", case, |stream| law.sample(stream)));
        assert!(p > FALSE_ALARM, "shape {shape}: p = {p}");
    }
}

#[test]
fn poisson_counts_are_rand_distrs() {
    for (case, mean) in [0.05, 1.0, 4.0, 9.9, 10.0, 57.0, 1000.0].into_iter().enumerate() {
        let law = Poisson::new(mean).unwrap();
        let ours = sample("ours", case, |stream| poisson(stream, mean));
        let theirs = sample("theirs", case, |stream| law.sample(stream) as u64);
        let p = same_counts(&ours, &theirs);
        assert!(p > FALSE_ALARM, "mean {mean}: p = {p}");
    }
}

#[test]
fn dirichlet_proportions_are_rand_distrs() {
    // Each proportion alone, and by Beta's law, which it has.
    let alphas = [0.5, 1.0, 2.0, 4.0];
    let law = Dirichlet::new(&alphas).unwrap();
    let concentration = Concentration::Each(alphas.to_vec());
    let ours = sample("ours", 0, |stream| dirichlet(&concentration, 4, stream));
    let theirs: Vec<Vec<f64>> = sample("theirs", 0, |stream| law.sample(stream));
    for (i, alpha) in alphas.into_iter().enumerate() {
        let proportion = |draws: &[Vec<f64>]| draws.iter().map(|p| p[i]).collect();
        let p = same_continuous(proportion(&ours), proportion(&theirs));
        assert!(p > FALSE_ALARM, "proportion {i}: p = {p}");
        let beta = Beta::new(alpha, 7.5 - alpha).unwrap();
        let p = same_continuous(proportion(&ours), sample("beta", i, |stream| beta.sample(stream)));
        assert!(p > FALSE_ALARM, "proportion {i} by Beta's law: p = {p}");
    }
}

#[test]
fn orders_are_rands() {
    // The six orders of three numbers, as numbers of three digits.
    let digits = |order: [u64; 3]| 100 * order[0] + 10 * order[1] + order[2];
    let ours = sample("ours", 0, |stream| {
        let mut order = [1, 2, 3];
        Stream::shuffle(stream, &mut order);
        digits(order)
    });
    let theirs = sample("theirs", 0, |stream| {
        let mut order = [1, 2, 3];
        SliceRandom::shuffle(&mut order[..], stream);
        digits(order)
    });
    let p = same_counts(&ours, &theirs);
    assert!(p > FALSE_ALARM, "p = {p}");
}

#[test]
fn a_different_law_is_noticed() {
    // The tests have power: a shape of 2.6 is not 2.5, a mean of 10.2 is not 10.
    let gamma = |name, shape| {
        let law = Gamma::new(shape, 1.0).unwrap();
        sample(name, 0, |stream| law.sample(stream))
    };
    assert!(same_continuous(gamma("ours", 2.5), gamma("theirs", 2.6)) < FALSE_ALARM);
    let counts = |name, mean| sample(name, 0, |stream| poisson(stream, mean));
    assert!(same_counts(&counts("ours", 10.0), &counts("theirs", 10.2)) < FALSE_ALARM);
}

#[test]
fn rands_methods_draw_from_the_streams_bits() {
    // What other crates draw is a function of the same bits as the crate's own draws.
    let stream = || Seed(7).attempt("stage", 3, 1);
    let (mut ours, mut theirs) = (stream(), stream());
    for _ in 0..100 {
        assert_eq!(ours.bits(), theirs.next_u64());
        assert_eq!(ours.bits(), theirs.random::<u64>());
        assert_eq!(ours.unit(), theirs.random::<f64>());
    }
    let mut bytes = [0; 24];
    theirs.fill_bytes(&mut bytes);
    let words = bytes.chunks_exact(8).map(|word| u64::from_le_bytes(word.try_into().unwrap()));
    assert!(words.eq([ours.bits(), ours.bits(), ours.bits()]));
    assert_eq!(["only"].choose(&mut ours), Some(&"only"));
}
