//! The distribution of a road's length among its segments.

/// A share below this length, in metres, is the rounding error of a share that is almost zero.
const VANISHING: f64 = 1e-9;

/// Returns the lengths of the segments: each is its minimum plus its proportion of the rest of `length`. The
/// lengths are multiples of the [`quantum`] and sum to `length` exactly, in any order. A length of less than a
/// nanometre becomes 0.
///
/// ```
/// use envgen::road::lengths;
///
/// // 100 m: 10 m at least for each, and the remaining 80 m by proportion.
/// assert_eq!(lengths(100.0, &[10.0, 10.0], &[0.25, 0.75]), [30.0, 70.0]);
/// ```
pub fn lengths(length: f64, minima: &[f64], proportions: &[f64]) -> Vec<f64> {
    let free = length - minima.iter().sum::<f64>();
    let mut lengths: Vec<f64> =
        minima.iter().zip(proportions).map(|(minimum, p)| minimum + free * p).collect();
    lengths.iter_mut().filter(|l| **l < VANISHING).for_each(|l| *l = 0.0);
    settle(&mut lengths, length);
    lengths
}

/// Rounds lengths that sum to about `length` so that they sum to it exactly: each is rounded down to a multiple of
/// the quantum, and the longest receives the rest.
pub(super) fn settle(lengths: &mut [f64], length: f64) {
    let quantum = quantum(length);
    lengths.iter_mut().for_each(|l| *l = (*l / quantum).floor() * quantum);
    let longest = (0..lengths.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
    if let Some(longest) = longest {
        let missing = length - lengths.iter().sum::<f64>();
        lengths[longest] += missing;
    }
}

/// Returns the least power of two whose multiples up to `length` are exact numbers, so that their sums up to
/// `length` are exact, too.
pub fn quantum(length: f64) -> f64 {
    let (_, exponent) = libm::frexp(length);
    libm::ldexp(1.0, exponent - 53)
}

/// Divides `count` in proportion to `lengths` by the method of the largest remainder: each receives the whole part
/// of its quota, and the rest goes to the largest fractions; of equal ones, to those with lower index.
///
/// ```
/// use envgen::road::largest_remainder;
///
/// // Quotas of 1.5, 1.5 and 3: the point that is left goes to the first of equals.
/// assert_eq!(largest_remainder(&[1.0, 1.0, 2.0], 6), [2, 1, 3]);
/// ```
pub fn largest_remainder(lengths: &[f64], count: u64) -> Vec<u64> {
    let total: f64 = lengths.iter().sum();
    let quotas: Vec<f64> = lengths.iter().map(|l| l / total * count as f64).collect();
    // A quota that is just under a whole number because of rounding is that number.
    let mut shares: Vec<u64> = quotas.iter().map(|q| (q + 1e-9).floor() as u64).collect();
    let given: u64 = shares.iter().sum();
    let mut order: Vec<usize> = (0..quotas.len()).collect();
    // In whole billionths, for which "about equal" is a consistent order.
    let fraction = |i: usize| ((quotas[i] - (quotas[i] + 1e-9).floor()).max(0.0) * 1e9).round();
    order.sort_by(|&a, &b| fraction(b).total_cmp(&fraction(a)).then(a.cmp(&b)));
    for &i in order.iter().take(count.saturating_sub(given) as usize) {
        shares[i] += 1;
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::{Concentration, dirichlet};
    use crate::seed::Seed;
    use proptest::prelude::*;

    #[test]
    fn equal_shares_go_to_the_lower_index() {
        assert_eq!(largest_remainder(&[1.0; 3], 10), [4, 3, 3]);
        assert_eq!(largest_remainder(&[1.0; 4], 10), [3, 3, 2, 2]);
        assert_eq!(largest_remainder(&[0.1; 7], 10), [2, 2, 2, 1, 1, 1, 1]);
        assert_eq!(largest_remainder(&[0.5, 0.25, 0.25], 2), [1, 1, 0]);
        // Hamilton's classic example.
        assert_eq!(largest_remainder(&[5.0, 3.0, 2.0, 0.0], 7), [4, 2, 1, 0]);
        assert_eq!(largest_remainder(&[3.0], 5), [5]);
    }

    #[test]
    fn fractions_that_hardly_differ_have_an_order() {
        // Each is about as large as the next, and the last is not about as large as the first.
        let lengths: Vec<f64> = (0..400).map(|i| 1.0 + 4e-10 * f64::from(i * 37 % 400)).collect();
        for count in [100, 600, 999] {
            let shares = largest_remainder(&lengths, count);
            assert_eq!(shares.iter().sum::<u64>(), count);
        }
    }

    proptest! {
        #[test]
        fn lengths_sum_to_what_is_given(
            seed: u64,
            exponent in -6.0..12.0_f64,
            count in 1..200_usize,
            length in 200.0..1e6_f64,
            minimum in 0.0..1.0_f64,
        ) {
            let alpha = Concentration::Same(libm::pow(10.0, exponent));
            let shares = dirichlet(&alpha, count, &mut Seed(seed).stream("test", 0));
            prop_assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let lengths = lengths(length, &vec![minimum; count], &shares);
            prop_assert_eq!(lengths.iter().sum::<f64>(), length);
            prop_assert_eq!(lengths.iter().rev().sum::<f64>(), length);
            prop_assert!(lengths.iter().all(|l| *l > minimum - 1e-9 || *l == 0.0));
        }

        #[test]
        fn every_share_is_its_quota_rounded(
            lengths in prop::collection::vec(0.0..1.0_f64, 1..40), count in 0..10_000_u64,
        ) {
            let total: f64 = lengths.iter().sum();
            prop_assume!(total > 0.0);
            let shares = largest_remainder(&lengths, count);
            prop_assert_eq!(shares.iter().sum::<u64>(), count);
            for (share, length) in shares.iter().zip(&lengths) {
                prop_assert!((*share as f64 - length / total * count as f64).abs() < 1.0 + 1e-8);
            }
        }
    }
}
