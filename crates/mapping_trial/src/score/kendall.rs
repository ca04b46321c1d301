//! Kendall's rank correlation.

use std::cmp::Ordering;

/// Returns Kendall's rank correlation tau-b (Kendall, Biometrika 33, 1945,
/// <https://doi.org/10.1093/biomet/33.3.239>), which allows for ties; `None` for lists of different
/// lengths, if all values of one list are equal, or if one is NaN.
///
/// Pairs in the other order are counted while the lists are sorted (Knight, JASA 61, 1966,
/// <https://doi.org/10.1080/01621459.1966.10480879>), in O(n log n) time.
///
/// ```
/// use mapping_trial::score::kendall_tau;
///
/// // Of six pairs, one is in the other order.
/// let tau = kendall_tau(&[1.0, 2.0, 3.0, 4.0], &[1.0, 3.0, 2.0, 4.0]);
/// assert!(tau.is_some_and(|tau| (tau - 4.0 / 6.0).abs() < 1e-12));
/// assert_eq!(kendall_tau(&[1.0, 1.0], &[1.0, 2.0]), None);
/// ```
pub fn kendall_tau(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.iter().chain(b).any(|value| value.is_nan()) {
        return None;
    }
    let mut pairs: Vec<(f64, f64)> = a.iter().copied().zip(b.iter().copied()).collect();
    let by_a = |p: &(f64, f64), q: &(f64, f64)| by_value(p.0, q.0);
    let by_both = |p: &(f64, f64), q: &(f64, f64)| by_a(p, q).then(by_value(p.1, q.1));
    pairs.sort_unstable_by(by_both);
    let all = pairs_among(pairs.len());
    let tied_a = tied_pairs(&pairs, by_a);
    let tied_both = tied_pairs(&pairs, by_both);
    let mut b: Vec<f64> = pairs.into_iter().map(|(_, b)| b).collect();
    let reversed = sort_counting(&mut b);
    let tied_b = tied_pairs(&b, |x, y| by_value(*x, *y));
    let untied = all - tied_a - tied_b + tied_both;
    let norm = ((all - tied_a) as f64 * (all - tied_b) as f64).sqrt();
    (norm > 0.0).then(|| (untied - 2 * reversed) as f64 / norm)
}

/// Compares numbers, of which -0 and 0 are equal. NaN has a place of its own.
pub(super) fn by_value(a: f64, b: f64) -> Ordering {
    // Adding 0 makes -0 the 0 that it is equal to.
    (a + 0.0).total_cmp(&(b + 0.0))
}

/// The number of pairs of `count` things.
fn pairs_among(count: usize) -> i64 {
    let count = count as i64;
    count * (count - 1) / 2
}

/// The number of pairs of equal values in a sorted list.
fn tied_pairs<T>(sorted: &[T], compare: impl Fn(&T, &T) -> Ordering) -> i64 {
    let ties = sorted.chunk_by(|x, y| compare(x, y) == Ordering::Equal);
    ties.map(|tie| pairs_among(tie.len())).sum()
}

/// Sorts the values and returns the number of pairs of which the greater one was first.
fn sort_counting(values: &mut [f64]) -> i64 {
    let mut reversed = 0;
    let mut merged = Vec::with_capacity(values.len());
    let mut run = 1;
    while run < values.len() {
        for both in values.chunks_mut(2 * run) {
            let (first, second) = both.split_at(run.min(both.len()));
            merged.clear();
            let (mut i, mut j) = (0, 0);
            while i < first.len() && j < second.len() {
                if by_value(first[i], second[j]).is_le() {
                    merged.push(first[i]);
                    i += 1;
                } else {
                    // Before all that is left of the first run.
                    reversed += (first.len() - i) as i64;
                    merged.push(second[j]);
                    j += 1;
                }
            }
            merged.extend_from_slice(&first[i..]);
            merged.extend_from_slice(&second[j..]);
            both.copy_from_slice(&merged);
        }
        run *= 2;
    }
    reversed
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn tau_counts_pairs() {
        assert_eq!(kendall_tau(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]), Some(1.0));
        assert_eq!(kendall_tau(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
        // One of six pairs in the wrong order.
        let tau = kendall_tau(&[1.0, 2.0, 3.0, 4.0], &[1.0, 3.0, 2.0, 4.0]).unwrap();
        assert!((tau - 4.0 / 6.0).abs() < 1e-12);
        // One tie: 5 concordant of sqrt(6 * 5).
        let tau = kendall_tau(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 2.0, 4.0]).unwrap();
        assert!((tau - 5.0 / 30.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(kendall_tau(&[1.0, 2.0], &[1.0, 1.0]), None);
        assert_eq!(kendall_tau(&[1.0], &[1.0, 2.0]), None);
    }

    #[test]
    fn zeros_are_equal_whatever_their_sign() {
        assert_eq!(kendall_tau(&[0.0, -0.0], &[1.0, 2.0]), None);
        assert_eq!(kendall_tau(&[0.0, -0.0, 1.0], &[-0.0, 0.0, 1.0]), Some(1.0));
    }

    #[test]
    fn many_pairs_are_counted_in_little_time() {
        // Of 1,000,001 numbers the first is the greatest in one list and the least in the other.
        let rising: Vec<f64> = (0..=1_000_000).map(f64::from).collect();
        let mut first_last = rising.clone();
        first_last[0] = 2e6;
        let n = 1_000_001.0;
        let tau = kendall_tau(&rising, &first_last).unwrap();
        assert!((tau - (1.0 - 4.0 / n)).abs() < 1e-12, "{tau}");
    }

    /// Numbers with many ties.
    fn number() -> impl Strategy<Value = f64> {
        let special = vec![-0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY];
        prop_oneof![
            6 => (-3..3_i32).prop_map(f64::from),
            2 => any::<f64>(),
            1 => prop::sample::select(special),
        ]
    }

    proptest! {
        #[test]
        fn tau_is_that_of_the_pairs_by_value(
            pairs in prop::collection::vec((number(), number()), 0..40),
        ) {
            let (a, b): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
            let found = kendall_tau(&a, &b);
            // The signs of the differences of all pairs.
            let sign = |x: f64, y: f64| f64::from(i8::from(x > y) - i8::from(x < y));
            let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
            for i in 0..pairs.len() {
                for j in 0..i {
                    let (one, two) = (sign(a[i], a[j]), sign(b[i], b[j]));
                    (ab, aa, bb) = (ab + one * two, aa + one * one, bb + two * two);
                }
            }
            let norm = (aa * bb).sqrt();
            prop_assert_eq!(found, (norm > 0.0).then(|| ab / norm));
            // The sign of zeros changes nothing.
            let flipped: Vec<f64> = a.iter().map(|&x| if x == 0.0 { -x } else { x }).collect();
            prop_assert_eq!(kendall_tau(&flipped, &b), found);
            // There is no order with NaN.
            if let Some(last) = b.len().checked_sub(1) {
                prop_assert_eq!(kendall_tau(&a, &[&b[..last], &[f64::NAN]].concat()), None);
            }
        }
    }
}
