//! The distribution of a road's length among its segments.

/// A share below this length, in metres, is the rounding error of a share that is almost zero.
const VANISHING: f64 = 1e-9;

/// A quota that is under a whole number by less than this, because of rounding, is that number.
const JUST_UNDER: f64 = 1e-9;

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
/// of its quota, and the rest goes to the largest fractions; of equal ones, to those with lower index. The shares sum
/// to `count`. Lengths that are all 0 count as equal; without lengths there are no shares.
///
/// ```
/// use envgen::road::largest_remainder;
///
/// // Quotas of 1.5, 1.5 and 3: the point that is left goes to the first of equals.
/// assert_eq!(largest_remainder(&[1.0, 1.0, 2.0], 6), [2, 1, 3]);
/// ```
///
/// # Panics
/// When a length is negative or NaN, or the sum of the lengths is not finite.
#[track_caller]
pub fn largest_remainder(lengths: &[f64], count: u64) -> Vec<u64> {
    if let Some(wrong) = lengths.iter().find(|length| length.is_nan() || **length < 0.0) {
        panic!("a length is {wrong}");
    }
    let total: f64 = lengths.iter().sum();
    assert!(total.is_finite(), "the sum of the lengths is {total}");
    if total == 0.0 {
        let equal = vec![1.0; lengths.len()];
        return if equal.is_empty() { Vec::new() } else { largest_remainder(&equal, count) };
    }
    // By how much rounding can change the quotas in all.
    let rounding = lengths.len() as f64 * (count as f64 * f64::EPSILON + JUST_UNDER);
    let quotas = if rounding < 0.01 { rounded_quotas } else { exact_quotas };
    let (mut shares, fractions) = quotas(lengths, total, count);
    let given: u64 = shares.iter().sum();
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&a, &b| fractions[b].cmp(&fractions[a]).then(a.cmp(&b)));
    for &i in order.iter().take(count.saturating_sub(given) as usize) {
        shares[i] += 1;
    }
    shares
}

/// Returns the whole parts of the quotas, and their fractions in whole billionths, for which "about equal" is a
/// consistent order.
fn rounded_quotas(lengths: &[f64], total: f64, count: u64) -> (Vec<u64>, Vec<u128>) {
    let quotas = lengths.iter().map(|l| l / total * count as f64);
    quotas
        .map(|quota| {
            let whole = (quota + JUST_UNDER).floor();
            (whole as u64, ((quota - whole).max(0.0) * 1e9).round() as u128)
        })
        .unzip()
}

/// Like [`rounded_quotas`], but in whole numbers, for counts whose quotas have few digits after the point, or none. The
/// unit of the fractions is another.
fn exact_quotas(lengths: &[f64], total: f64, count: u64) -> (Vec<u64>, Vec<u128>) {
    // Each length is a whole number of units, up to half of one. All together are less than 2^63, so that products with
    // the count are less than 2^127.
    let (_, exponent) = libm::frexp(total);
    let weights = lengths.iter().map(|l| libm::ldexp(*l, 62 - exponent).round() as u128);
    let weights: Vec<u128> = weights.collect();
    let total: u128 = weights.iter().sum();
    let product = |weight: u128| weight * u128::from(count);
    weights.into_iter().map(|w| ((product(w) / total) as u64, product(w) % total)).unzip()
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
    fn nothing_is_divided_equally() {
        assert_eq!(largest_remainder(&[0.0, 0.0], 5), [3, 2]);
        assert_eq!(largest_remainder(&[0.0], u64::MAX), [u64::MAX]);
        assert_eq!(largest_remainder(&[-0.0, 0.0, 0.0], 3), [1, 1, 1]);
        assert!(largest_remainder(&[], 5).is_empty());
    }

    #[test]
    fn large_counts_are_divided_to_the_last_one() {
        let count = 1_000_000_000_000_000_003;
        assert_eq!(largest_remainder(&[1.0], count), [count]);
        assert_eq!(largest_remainder(&[1.0, 1.0], count), [count / 2 + 1, count / 2]);
        let third = (count - 1) / 3;
        assert_eq!(largest_remainder(&[1.0, 2.0], count), [third, 2 * third + 1]);
        assert_eq!(largest_remainder(&[0.0, 3e300], u64::MAX), [0, u64::MAX]);
        assert_eq!(largest_remainder(&[5e-324; 3], u64::MAX), [u64::MAX / 3; 3]);
    }

    #[test]
    fn lengths_without_meaning_are_a_mistake_of_the_program() {
        for (lengths, expected) in [
            ([1.0, f64::NAN], "a length is NaN"),
            ([-1.0, 2.0], "a length is -1"),
            ([f64::INFINITY, 2.0], "the sum of the lengths is inf"),
            ([1.5e308, 1.5e308], "the sum of the lengths is inf"),
        ] {
            let caught = std::panic::catch_unwind(|| largest_remainder(&lengths, 3));
            let payload = caught.expect_err("it panics");
            assert_eq!(payload.downcast_ref::<String>().map(String::as_str), Some(expected));
        }
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
        fn every_count_is_divided(
            lengths in prop::collection::vec(0..1000_u32, 1..40), count: u64, digits in 0..64_u32,
        ) {
            let count = count >> digits;
            let floats: Vec<f64> = lengths.iter().map(|&length| f64::from(length)).collect();
            let shares = largest_remainder(&floats, count);
            prop_assert_eq!(shares.iter().map(|&share| u128::from(share)).sum::<u128>(), u128::from(count));
            let total: u128 = lengths.iter().map(|&length| u128::from(length)).sum();
            for (&share, &length) in shares.iter().zip(&lengths).filter(|_| total > 0) {
                let exact = u128::from(length) * u128::from(count);
                let error = (u128::from(share) * total).abs_diff(exact);
                prop_assert!(50 * error <= 51 * total, "{} is not its quota rounded", share);
            }
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
