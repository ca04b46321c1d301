//! Ridge regression: least squares with a penalty on the size of the coefficients.

use nalgebra::{DMatrix, DVector};

/// The penalties among which cross-validation chooses.
const PENALTIES: [f64; 9] = [0.3, 1.0, 3.0, 10.0, 30.0, 60.0, 100.0, 200.0, 400.0];

/// Number of folds: parts of the data that are left out one after the other.
pub(super) const FOLDS: usize = 10;

/// A linear model of standardised inputs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ridge {
    /// The mean of the predicted values.
    pub(super) intercept: f64,
    /// One coefficient per input.
    pub(super) coefficients: Vec<f64>,
    /// The prediction for each row by the model of the other folds.
    pub(super) left_out: Vec<f64>,
}

/// Fits rows of inputs, each of mean 0 and deviation 1, with the penalty that predicts left-out data
/// best. Neighbouring rows are in different folds.
pub(super) fn fit(rows: &[Vec<f64>], values: &[f64]) -> Ridge {
    let left_out = |penalty: f64| {
        let mut predicted = vec![0.0; rows.len()];
        for fold in 0..FOLDS {
            let own = |i: &usize| i % FOLDS == fold;
            let rest: Vec<usize> = (0..rows.len()).filter(|i| !own(i)).collect();
            let (intercept, slopes) = solve(rows, values, &rest, penalty);
            for i in (0..rows.len()).filter(own) {
                predicted[i] = intercept + dot(&slopes, &rows[i]);
            }
        }
        predicted
    };
    let error = |predicted: &[f64]| squared_error(predicted, values);
    let tried = PENALTIES.map(|penalty| (penalty, left_out(penalty)));
    let best = tried.into_iter().reduce(
        |best, next| {
            if error(&next.1) < error(&best.1) { next } else { best }
        },
    );
    let (penalty, left_out) = best.unwrap_or_default();
    let all: Vec<usize> = (0..rows.len()).collect();
    let (intercept, coefficients) = solve(rows, values, &all, penalty);
    Ridge { intercept, coefficients, left_out }
}

/// Sum of squared differences.
pub(super) fn squared_error(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Returns the intercept and the coefficients for some of the rows.
fn solve(rows: &[Vec<f64>], values: &[f64], of: &[usize], penalty: f64) -> (f64, Vec<f64>) {
    let inputs = rows.first().map_or(0, Vec::len);
    let n = of.len().max(1) as f64;
    let mean = of.iter().map(|&i| values[i]).sum::<f64>() / n;
    let middles: Vec<f64> =
        (0..inputs).map(|j| of.iter().map(|&i| rows[i][j]).sum::<f64>() / n).collect();
    let x = DMatrix::from_fn(of.len(), inputs, |i, j| rows[of[i]][j] - middles[j]);
    let y = DVector::from_fn(of.len(), |i, _| values[of[i]] - mean);
    let normal = x.tr_mul(&x) + DMatrix::from_diagonal_element(inputs, inputs, penalty);
    let slopes = normal.cholesky().map(|factors| factors.solve(&x.tr_mul(&y)));
    let slopes = slopes.map_or_else(|| vec![0.0; inputs], |slopes| slopes.as_slice().to_vec());
    (mean - dot(&slopes, &middles), slopes)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use envgen::Seed;

    use super::*;

    /// Rows of 8 inputs, of which the first two matter.
    fn data(noise: f64) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut draws = Seed(3).stream("ridge", 0);
        // Uniform numbers of deviation 1.
        let mut draw = || draws.between(-1.732, 1.732);
        let rows: Vec<Vec<f64>> = (0..300).map(|_| (0..8).map(|_| draw()).collect()).collect();
        let values = rows.iter().map(|row| 5.0 + 2.0 * row[0] - row[1] + noise * draw()).collect();
        (rows, values)
    }

    #[test]
    fn planes_are_found() {
        let (rows, values) = data(0.0);
        let found = fit(&rows, &values);
        assert!((found.intercept - 5.0).abs() < 0.01, "{found:?}");
        for (found, truth) in found.coefficients.iter().zip([2.0, -1.0, 0.0, 0.0]) {
            assert!((found - truth).abs() < 0.01, "{found} {truth}");
        }
    }

    #[test]
    fn what_is_left_out_is_predicted_up_to_the_noise() {
        let (rows, values) = data(0.5);
        let found = fit(&rows, &values);
        let error = squared_error(&found.left_out, &values) / values.len() as f64;
        // The variance of the noise; false alarms beyond five standard deviations of its estimate.
        assert!((error / 0.25 - 1.0).abs() < 5.0 * (2.0_f64 / 300.0).sqrt(), "{error}");
    }

    #[test]
    fn noise_alone_has_small_coefficients() {
        let (rows, _) = data(0.0);
        let mut draws = Seed(4).stream("ridge", 1);
        let noise: Vec<f64> = rows.iter().map(|_| draws.between(-1.0, 1.0)).collect();
        assert!(fit(&rows, &noise).coefficients.iter().all(|slope| slope.abs() < 0.1));
    }
}
