//! The continuous and discrete distributions from which the generators draw.
//!
//! [`rand_distr`](https://docs.rs/rand_distr) has these distributions too, but its floating-point functions come
//! from libm or from the platform, depending on which other crates of a build enable `num-traits/std`. A seed would
//! then give different worlds in different programs. The few distributions that the generators need are therefore
//! implemented here with `libm` alone, and give the same bits with every set of features. The tests compare each of
//! them with the one of `rand_distr`.
//!
//! # Other distributions
//!
//! A [`Stream`] is a random number generator of `rand_core` 0.10, so every distribution of `rand` 0.10 and
//! `rand_distr` 0.6 can be sampled from it:
//!
//! ```
//! use envgen::Seed;
//! use rand::RngExt;
//! use rand_distr::{Distribution, Triangular, UnitDisc, Weibull};
//!
//! let mut stream = Seed(7).stream("wind", 0);
//! let speed: f64 = Weibull::new(8.0, 2.0)?.sample(&mut stream);
//! let gusts: Vec<f64> = (&mut stream).sample_iter(Triangular::new(0.0, 3.0, 1.0)?).take(4).collect();
//! let [x, y]: [f64; 2] = stream.sample(UnitDisc);
//! assert!(speed > 0.0 && gusts.len() == 4 && x * x + y * y <= 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With the feature `rand`, generators accept such distributions in place of their own: for the radii of trees
//! (`forest::ForestLaws`), the lengths of a road's segments and its turns (`road::RoadLaws`), the distances between
//! hallways and the contents of rooms (`indoor::IndoorLaws`). `Truncated` keeps their values within limits. Their
//! bits are those of the crate that they come from, in the version and with the features with which it is built.
//! The feature adds only the crate `rand` itself, without its default features, and does not change any world that
//! is drawn from the distributions in this module.

mod law;
#[cfg(feature = "rand")]
mod truncated;

pub(crate) use law::Law;
#[cfg(feature = "rand")]
pub(crate) use law::law;
#[cfg(feature = "rand")]
pub use truncated::Truncated;

use crate::seed::Stream;

/// Draws a number from the standard normal distribution (Marsaglia's polar method).
///
/// ```
/// use envgen::{Seed, distribution::standard_normal};
///
/// // Heights of mean 1.7 m with a standard deviation of 0.1 m.
/// let mut stream = Seed(7).stream("people", 0);
/// let heights: Vec<f64> = (0..10_000).map(|_| 1.7 + 0.1 * standard_normal(&mut stream)).collect();
/// let mean = heights.iter().sum::<f64>() / 1e4;
/// assert!((mean - 1.7).abs() < 0.005);
/// ```
pub fn standard_normal(stream: &mut Stream) -> f64 {
    loop {
        let x = 2.0 * stream.unit() - 1.0;
        let y = 2.0 * stream.unit() - 1.0;
        let s = x * x + y * y;
        if s > 0.0 && s < 1.0 {
            return x * (-2.0 * libm::log(s) / s).sqrt();
        }
    }
}

/// Draws a gamma variate of the given shape and of scale 1, and returns its natural logarithm. The shape must be
/// positive and finite. The logarithm stays finite where the variate of a small shape would be 0, for shapes of
/// 1e-306 or more. That of a smaller shape may be too far below 0 for an `f64`: it is then negative infinity.
///
/// The method is that of G. Marsaglia and W. W. Tsang, A simple method for generating gamma variables, ACM
/// Transactions on Mathematical Software 26, 2000, <https://doi.org/10.1145/358407.358414>; for shapes below 1 with
/// the factor of their section 6.
///
/// ```
/// use envgen::{Seed, distribution::ln_gamma_variate};
///
/// // The mean of the law is its shape.
/// let mut stream = Seed(7).stream("example", 0);
/// let sum: f64 = (0..10_000).map(|_| libm::exp(ln_gamma_variate(&mut stream, 4.0))).sum();
/// assert!((sum / 1e4 - 4.0).abs() < 0.1);
/// // Tiny shapes give variates that are too small for an `f64`; their logarithms stay finite.
/// assert!(ln_gamma_variate(&mut stream, 1e-6).is_finite());
/// ```
///
/// # Panics
/// When the shape is not positive and finite.
#[track_caller]
pub fn ln_gamma_variate(stream: &mut Stream, shape: f64) -> f64 {
    assert!(shape > 0.0 && shape.is_finite(), "the shape of a gamma law is {shape}");
    if shape < 1.0 {
        let boost = libm::log(1.0 - stream.unit()) / shape;
        return ln_gamma_variate(stream, shape + 1.0) + boost;
    }
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / (9.0 * d).sqrt();
    loop {
        let x = standard_normal(stream);
        let v = 1.0 + c * x;
        if v <= 0.0 {
            continue;
        }
        let ln_v = 3.0 * libm::log(v);
        let v = v * v * v;
        let u = 1.0 - stream.unit();
        if libm::log(u) < 0.5 * x * x + d * (1.0 - v + ln_v) {
            return libm::log(d) + ln_v;
        }
    }
}

/// Draws a Poisson count of the given mean, which must be finite, not negative and at most 1e15.
///
/// Below a mean of 10 the method is Knuth's product of uniform numbers; above, it is Hörmann's transformed
/// rejection PTRS (W. Hörmann, The transformed rejection method for generating Poisson random variables, Insurance:
/// Mathematics and Economics 12, 1993, <https://doi.org/10.1016/0167-6687(93)90997-4>).
///
/// ```
/// use envgen::{Seed, distribution::poisson};
///
/// let mut stream = Seed(7).stream("trees per hectare", 0);
/// let counts: Vec<u64> = (0..10_000).map(|_| poisson(&mut stream, 40.0)).collect();
/// let mean = counts.iter().sum::<u64>() as f64 / 1e4;
/// assert!((mean - 40.0).abs() < 0.3);
/// assert_eq!(poisson(&mut stream, 0.0), 0);
/// ```
///
/// # Panics
/// When the mean is negative, NaN or above 1e15.
#[track_caller]
pub fn poisson(stream: &mut Stream, mean: f64) -> u64 {
    assert!((0.0..=1e15).contains(&mean), "the mean of a Poisson law is {mean}");
    if mean < 10.0 {
        let limit = libm::exp(-mean);
        let mut product = stream.unit();
        let mut count = 0;
        while product > limit {
            product *= stream.unit();
            count += 1;
        }
        return count;
    }
    let b = 0.931 + 2.53 * mean.sqrt();
    let a = -0.059 + 0.024_83 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let v_r = 0.9277 - 3.6224 / (b - 2.0);
    let ln_mean = libm::log(mean);
    loop {
        let u = stream.unit() - 0.5;
        let v = stream.unit();
        let us = 0.5 - u.abs();
        let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
        if us >= 0.07 && v <= v_r {
            return k as u64;
        }
        if k < 0.0 || (us < 0.013 && v > us) {
            continue;
        }
        let left = libm::log(v) + libm::log(inverse_alpha) - libm::log(a / (us * us) + b);
        if left <= k * ln_mean - mean - libm::lgamma(k + 1.0) {
            return k as u64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use statrs::distribution::{ChiSquared, ContinuousCDF, Discrete, Gamma, Normal, Poisson};

    /// Chi-square of binned draws against expected bin probabilities; returns the p-value.
    fn p_value(observed: &[u64], expected: &[f64]) -> f64 {
        let n: u64 = observed.iter().sum();
        let chi2: f64 = observed
            .iter()
            .zip(expected)
            .map(|(&o, &p)| {
                let e = p * n as f64;
                (o as f64 - e) * (o as f64 - e) / e
            })
            .sum();
        1.0 - ChiSquared::new((observed.len() - 1) as f64).unwrap().cdf(chi2)
    }

    #[test]
    fn poisson_follows_its_law() {
        // Seven means, false-alarm rate 1e-4 each.
        for (case, mean) in [0.05, 1.0, 4.0, 9.9, 10.0, 57.0, 1000.0].into_iter().enumerate() {
            let law = Poisson::new(mean).unwrap();
            let mut stream = Seed(case as u64).stream("poisson", 0);
            let half = 3.0 * mean.sqrt() + 1.0;
            let low = (mean - half).max(0.0).floor() as u64;
            let high = (mean + half).ceil() as u64;
            let bins = (high - low + 1) as usize;
            let mut observed = vec![0_u64; bins];
            for _ in 0..100_000 {
                observed[poisson(&mut stream, mean).clamp(low, high) as usize - low as usize] += 1;
            }
            let mut expected: Vec<f64> = (low..=high).map(|k| law.pmf(k)).collect();
            expected[0] += (0..low).map(|k| law.pmf(k)).sum::<f64>();
            expected[bins - 1] = 1.0 - expected[..bins - 1].iter().sum::<f64>();
            // Bins that expect under five draws are joined to their neighbour.
            let (mut o, mut e) = (vec![0], vec![0.0]);
            for (a, b) in observed.iter().zip(&expected) {
                if *e.last().unwrap() * 1e5 >= 5.0 {
                    o.push(0);
                    e.push(0.0);
                }
                *o.last_mut().unwrap() += a;
                *e.last_mut().unwrap() += b;
            }
            if e.len() > 1 && *e.last().unwrap() * 1e5 < 5.0 {
                let (a, b) = (o.pop().unwrap(), e.pop().unwrap());
                *o.last_mut().unwrap() += a;
                *e.last_mut().unwrap() += b;
            }
            let p = p_value(&o, &e);
            assert!(p > 1e-4, "mean {mean}: p = {p}");
        }
    }

    #[test]
    fn normal_follows_its_law() {
        let law = Normal::standard();
        let mut stream = Seed(1).stream("normal", 0);
        let edges: Vec<f64> = (-12..=12).map(|i| f64::from(i) * 0.25).collect();
        let mut observed = vec![0_u64; edges.len() + 1];
        for _ in 0..100_000 {
            let x = standard_normal(&mut stream);
            observed[edges.iter().filter(|&&e| x >= e).count()] += 1;
        }
        let mut cdf = vec![0.0];
        cdf.extend(edges.iter().map(|&e| law.cdf(e)));
        cdf.push(1.0);
        let expected: Vec<f64> = cdf.windows(2).map(|w| w[1] - w[0]).collect();
        let p = p_value(&observed, &expected);
        assert!(p > 1e-4, "p = {p}");
    }

    #[test]
    fn gamma_follows_its_law() {
        // Twenty equally likely bins each, false-alarm rate 1e-4 a shape. Shapes that small put most
        // of their mass where the variate itself underflows.
        for (case, shape) in [0.02, 0.3, 1.0, 2.5, 40.0, 1e4].into_iter().enumerate() {
            let law = Gamma::new(shape, 1.0).unwrap();
            let mut stream = Seed(case as u64).stream("gamma", 0);
            let mut observed = vec![0_u64; 20];
            for _ in 0..50_000 {
                let x = libm::exp(ln_gamma_variate(&mut stream, shape));
                let bin = (law.cdf(x) * 20.0) as usize;
                observed[bin.min(19)] += 1;
            }
            let p = p_value(&observed, &[0.05; 20]);
            assert!(p > 1e-4, "shape {shape}: p = {p} of {observed:?}");
        }
    }

    #[test]
    fn gamma_of_a_tiny_shape_keeps_its_logarithm() {
        // For a shape a near 0, -a ln G is exponential of mean 1: of 10 000 draws, within 5 sigma.
        let mut stream = Seed(3).stream("tiny", 0);
        let draws = (0..10_000).map(|_| -1e-6 * ln_gamma_variate(&mut stream, 1e-6));
        let mean = draws.inspect(|x| assert!(x.is_finite())).sum::<f64>() / 1e4;
        assert!((mean - 1.0).abs() < 0.05, "{mean}");
    }

    #[test]
    fn gamma_of_the_least_shapes_has_no_finite_logarithm() {
        let mut stream = Seed(4).stream("tiny", 0);
        let mut draws =
            |shape| (0..1000).map(|_| ln_gamma_variate(&mut stream, shape)).collect::<Vec<_>>();
        assert!(draws(1e-306).iter().all(|draw| draw.is_finite() && *draw < 0.0));
        assert!(draws(1e-310).contains(&f64::NEG_INFINITY));
        assert!(draws(f64::MIN_POSITIVE).iter().all(|draw| !draw.is_nan()));
        // The farthest from 0 that a draw of the first shape can be, by the least number that `1 - unit()` is.
        assert!((libm::log(0.5 * f64::EPSILON) / 1e-306).is_finite());
    }

    #[test]
    fn poisson_of_zero_is_zero() {
        let mut stream = Seed(2).stream("zero", 0);
        assert!((0..1000).all(|_| poisson(&mut stream, 0.0) == 0));
    }
}
