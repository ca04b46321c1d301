//! Means and quantiles.

/// Returns the mean; 0 without values.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns a quantile of sorted values, interpolated linearly (type 7 of R. J. Hyndman and Y. Fan, Sample quantiles
/// in statistical packages, 1996, <https://doi.org/10.1080/00031305.1996.10473566>); 0 without values.
pub(super) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let at = share * last as f64;
    let low = (at as usize).min(last);
    let high = (low + 1).min(last);
    sorted[low] + (sorted[high] - sorted[low]) * (at - low as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        let values = [1.0, 2.0, 4.0];
        let found = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| quantile(&values, share));
        assert_eq!(found, [1.0, 1.5, 2.0, 3.0, 4.0]);
        assert_eq!((quantile(&[], 0.5), mean(&[])), (0.0, 0.0));
        assert_eq!(mean(&values), 7.0 / 3.0);
    }
}
