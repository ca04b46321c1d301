//! Linear models that predict the dials.

use serde::{Deserialize, Serialize};

use crate::dials::{Dials, Estimate};

/// A number on which models depend by `ln(1 + x / scale)`, and its distribution in the atlas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// The name of the number.
    pub name: String,
    /// The scale: the median of the number in the atlas, where it is not 0.
    pub scale: f64,
    /// Mean of the logarithm, which is used for worlds that do not have the number.
    pub mean: f64,
    /// Standard deviation of the logarithm.
    pub deviation: f64,
    /// Least and greatest value of the logarithm.
    pub range: [f64; 2],
}

/// A linear model of one dial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearModel {
    /// The predicted value if every input has its mean.
    pub intercept: f64,
    /// The increase per standard deviation of each input.
    pub coefficients: Vec<f64>,
    /// Standard errors of predictions at 0 and at 10. Between these, the standard error is interpolated linearly.
    pub standard_errors: [f64; 2],
    /// Share of the variance between worlds of the atlas that is explained by predictions of worlds that were left
    /// out of the fit.
    pub explained: f64,
}

/// Models of all dials with the same inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DialModels {
    /// The inputs.
    pub inputs: Vec<Input>,
    /// The models.
    pub models: Dials<LinearModel>,
}

impl Input {
    /// Returns the logarithm `ln(1 + value / scale)`.
    pub fn logarithm(value: f64, scale: f64) -> f64 {
        libm::log1p(value.max(0.0) / scale)
    }

    /// Returns a value in standard deviations from the mean, clamped to the range of the atlas, and whether it was
    /// clamped.
    pub fn standardised(&self, value: Option<f64>) -> (f64, bool) {
        let Some(value) = value.filter(|value| value.is_finite()) else { return (0.0, false) };
        let [least, most] = self.range;
        let log = Input::logarithm(value, self.scale);
        let inside = log.clamp(least, most);
        // What is beyond by less than a hundredth of a deviation is rounding.
        let is_cut = (log - inside).abs() > 0.01 * self.deviation;
        ((inside - self.mean) / self.deviation, is_cut)
    }
}

impl LinearModel {
    /// Returns the prediction and its standard error for standardised inputs.
    pub fn at(&self, inputs: &[f64]) -> Estimate {
        let terms = self.coefficients.iter().zip(inputs).map(|(slope, x)| slope * x);
        let value = terms.fold(self.intercept, |sum, term| sum + term);
        let [low, high] = self.standard_errors;
        let part = (value / 10.0).clamp(0.0, 1.0);
        Estimate { value, standard_error: low + (high - low) * part }
    }
}

impl DialModels {
    /// Returns the predicted dials, and the share of the inputs that lie outside the range of the atlas.
    pub fn predict(&self, value: &dyn Fn(&str) -> Option<f64>) -> (Dials<Estimate>, f64) {
        let standardised: Vec<(f64, bool)> =
            self.inputs.iter().map(|input| input.standardised(value(&input.name))).collect();
        let cut = standardised.iter().filter(|(_, is_cut)| *is_cut).count();
        let inputs: Vec<f64> = standardised.into_iter().map(|(x, _)| x).collect();
        let outside = cut as f64 / self.inputs.len().max(1) as f64;
        (self.models.as_ref().map(|model| model.at(&inputs)), outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn models() -> DialModels {
        let input = |name: &str| Input {
            name: name.to_owned(),
            scale: 1.0,
            mean: 1.0,
            deviation: 0.5,
            range: [0.0, 2.0],
        };
        let model = LinearModel {
            intercept: 4.0,
            coefficients: vec![2.0, -1.0],
            standard_errors: [0.5, 1.5],
            explained: 0.8,
        };
        let models = Dials {
            difficulty: model.clone(),
            mapping: model.clone(),
            navigation: LinearModel { coefficients: vec![0.0, 0.0], ..model },
        };
        DialModels { inputs: vec![input("a"), input("b")], models }
    }

    fn at(a: f64, b: Option<f64>) -> (Dials<Estimate>, f64) {
        models().predict(&move |name| if name == "a" { Some(a) } else { b })
    }

    #[test]
    fn models_are_linear_in_logarithms() {
        let mean = libm::expm1(1.0);
        let (dials, outside) = at(mean, Some(mean));
        assert!((dials.difficulty.value - 4.0).abs() < 1e-12);
        assert!((dials.difficulty.standard_error - 0.9).abs() < 1e-12);
        assert_eq!(outside, 0.0);
        let (dials, _) = at(libm::expm1(1.5), Some(mean));
        assert!((dials.mapping.value - 6.0).abs() < 1e-12, "{dials:?}");
        assert_eq!(dials.navigation.value, 4.0);
    }

    #[test]
    fn what_is_missing_counts_as_the_mean_and_what_is_outside_as_the_border() {
        let mean = libm::expm1(1.0);
        assert_eq!(at(mean, None), at(mean, Some(f64::NAN)));
        let (border, _) = at(libm::expm1(2.0), None);
        for far in [1e9, f64::MAX] {
            let (dials, outside) = at(far, None);
            assert!((dials.difficulty.value - border.difficulty.value).abs() < 1e-9);
            assert_eq!(outside, 0.5);
        }
        assert_eq!(at(-5.0, None).0, at(0.0, None).0);
    }
}
