//! Least-squares regression within levels.

/// Subtracts the mean of each level, so that only the variation between maps of one level is left.
pub(super) fn within(levels: &[usize], values: &mut [f64]) {
    let mut rest = values;
    for group in levels.chunk_by(|a, b| a == b) {
        let (own, others) = rest.split_at_mut(group.len());
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        own.iter_mut().for_each(|value| *value -= mean);
        rest = others;
    }
}

/// Returns the slope of `y` over `x`, both of mean 0; `None` if `x` does not vary.
pub(super) fn slope(x: &[f64], y: &[f64]) -> Option<f64> {
    let xx: f64 = x.iter().map(|x| x * x).sum();
    let xy: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
    (xx > 1e-12 * x.len() as f64).then(|| xy / xx)
}

/// Returns the slopes of `y` over several `x` at once, all of mean 0, by the normal equations; `None`
/// if the columns are nearly dependent on each other.
pub(super) fn slopes<const N: usize>(xs: &[Vec<f64>; N], y: &[f64]) -> Option<[f64; N]> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Columns of length 1, so that the test for nearly 0 does not depend on units.
    let lengths: [f64; N] = std::array::from_fn(|i| dot(&xs[i], &xs[i]).sqrt());
    if lengths.iter().any(|&length| length <= 1e-6 * (y.len() as f64).sqrt()) {
        return None;
    }
    let mut rows: [[f64; N]; N] = std::array::from_fn(|i| {
        std::array::from_fn(|j| dot(&xs[i], &xs[j]) / (lengths[i] * lengths[j]))
    });
    let mut right: [f64; N] = std::array::from_fn(|i| dot(&xs[i], y) / lengths[i]);
    for i in 0..N {
        // The matrix is positive definite: no exchange of rows is needed.
        if rows[i][i] < 1e-6 {
            return None;
        }
        for j in i + 1..N {
            let factor = rows[j][i] / rows[i][i];
            let pivot = rows[i];
            rows[j].iter_mut().zip(pivot).for_each(|(a, b)| *a -= factor * b);
            right[j] -= factor * right[i];
        }
    }
    let mut found = [0.0; N];
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|j| rows[i][j] * found[j]).sum();
        found[i] = (right[i] - known) / rows[i][i];
    }
    Some(std::array::from_fn(|i| found[i] / lengths[i]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn level_means_are_taken_away() {
        let mut values = [1.0, 3.0, 10.0, 10.0, 16.0];
        within(&[0, 0, 1, 1, 1], &mut values);
        assert_eq!(values, [-1.0, 1.0, -2.0, -2.0, 4.0]);
    }

    #[test]
    fn columns_that_depend_on_each_other_have_no_slopes() {
        let x = vec![1.0, -1.0, 2.0, -2.0];
        let twice: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        assert_eq!(slopes(&[x.clone(), twice], &[1.0, 2.0, 3.0, -6.0]), None);
        assert_eq!(slopes(&[x.clone(), vec![0.0; 4]], &x), None);
        assert_eq!(slope(&[0.0; 4], &x), None);
    }

    proptest! {
        #[test]
        fn exact_planes_are_found(
            a in prop::collection::vec(-9.0..9.0_f64, 12),
            b in prop::collection::vec(-9.0..9.0_f64, 12),
            (p, q) in (-5.0..5.0_f64, -5.0..5.0_f64),
        ) {
            let (mut a, mut b) = (a, b);
            within(&[0; 12], &mut a);
            within(&[0; 12], &mut b);
            let y: Vec<f64> = a.iter().zip(&b).map(|(a, b)| p * a + q * b).collect();
            if let Some([found_p, found_q]) = slopes(&[a.clone(), b], &y) {
                prop_assert!((found_p - p).abs() < 1e-6 && (found_q - q).abs() < 1e-6);
            }
            let scaled: Vec<f64> = a.iter().map(|a| p * a).collect();
            if let Some(found) = slope(&a, &scaled) {
                prop_assert!((found - p).abs() < 1e-9);
            }
        }
    }
}
