//! How a road's length is shared out among its segments.

use super::spec::Concentration;
use crate::distribution::ln_gamma_variate;
use crate::seed::Stream;

/// Shares below this length in metres are rounding of what the law makes next to nothing of.
const VANISHING: f64 = 1e-9;

/// Proportions drawn from a Dirichlet law, which sum to 1: `count` of them, all with the one
/// concentration or each with its own.
///
/// Gamma variates are drawn and normalised as logarithms, so that a concentration of 1e-6 is as
/// good as any: one proportion is then 1 and the others are 0, as the law has it.
pub fn dirichlet(alpha: &Concentration, count: usize, stream: &mut Stream) -> Vec<f64> {
    if count == 1 {
        return vec![1.0];
    }
    let mut shares: Vec<f64> =
        (0..count).map(|i| ln_gamma_variate(stream, alpha.of(i))).collect();
    let greatest = shares.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    shares.iter_mut().for_each(|share| *share = libm::exp(*share - greatest));
    let total: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|share| *share /= total);
    shares
}

/// Lengths of the segments: each its minimum and its proportion of what is left of `length`. They
/// sum to `length` up to one rounding; a length of under a nanometre becomes 0.
pub fn lengths(length: f64, minima: &[f64], proportions: &[f64]) -> Vec<f64> {
    let free = length - minima.iter().sum::<f64>();
    let mut lengths: Vec<f64> =
        minima.iter().zip(proportions).map(|(minimum, p)| minimum + free * p).collect();
    lengths.iter_mut().filter(|l| **l < VANISHING).for_each(|l| *l = 0.0);
    let longest = (0..lengths.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
    if let Some(longest) = longest {
        let missing = length - lengths.iter().sum::<f64>();
        lengths[longest] += missing;
    }
    lengths
}

/// Shares `count` out in proportion to `lengths` by largest remainder: each gets the whole part of
/// its quota, and what is left goes to the largest fractions, to the lower index among equals.
pub fn largest_remainder(lengths: &[f64], count: u64) -> Vec<u64> {
    let total: f64 = lengths.iter().sum();
    let quotas: Vec<f64> = lengths.iter().map(|l| l / total * count as f64).collect();
    // A quota that rounding left just under a whole number is that number.
    let mut shares: Vec<u64> = quotas.iter().map(|q| (q + 1e-9).floor() as u64).collect();
    let given: u64 = shares.iter().sum();
    let mut order: Vec<usize> = (0..quotas.len()).collect();
    let fraction = |i: usize| (quotas[i] - (quotas[i] + 1e-9).floor()).max(0.0);
    order.sort_by(|&a, &b| {
        let near = (fraction(a) - fraction(b)).abs() < 1e-9;
        if near { a.cmp(&b) } else { fraction(b).total_cmp(&fraction(a)) }
    });
    for &i in order.iter().take(count.saturating_sub(given) as usize) {
        shares[i] += 1;
    }
    shares
}
