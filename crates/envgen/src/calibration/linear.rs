//! Linear models that predict the dials.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::dials::{Dials, Estimate};
use crate::error::SpecError;

/// What is beyond a range by less than this, in standard deviations of the logarithm, is rounding.
const ROUNDING: f64 = 0.01;

/// How far below a range the models of smaller worlds take over, in standard deviations of the logarithm.
const FADE: f64 = 0.2;

/// A number on which models depend by `ln(1 + x / scale)`, and its distribution in the atlas. It is checked when it
/// is read from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedInput")]
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

/// An input as it is read from a file, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedInput {
    name: String,
    scale: f64,
    mean: f64,
    deviation: f64,
    range: [f64; 2],
}

impl TryFrom<UncheckedInput> for Input {
    type Error = SpecError;

    fn try_from(read: UncheckedInput) -> Result<Self, SpecError> {
        let UncheckedInput { name, scale, mean, deviation, range } = read;
        let refused = |field: &str, value: &dyn fmt::Display, allowed: &str| {
            Err(SpecError::new(field, value, allowed).within(&name))
        };
        for (field, value) in [("scale", scale), ("deviation", deviation)] {
            if !(value > 0.0 && value.is_finite()) {
                return refused(field, &value, "a positive finite number");
            }
        }
        if !mean.is_finite() {
            return refused("mean", &mean, "a finite number");
        }
        let [least, most] = range;
        if !(least <= most && least.is_finite() && most.is_finite()) {
            let given = format!("{least} and {most}");
            return refused("range", &given, "two finite numbers, the least first");
        }
        Ok(Input { name, scale, mean, deviation, range })
    }
}

/// A linear model of one dial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearModel {
    /// The predicted value if every input has its mean.
    pub intercept: f64,
    /// The increase per standard deviation of each input. There are as many as inputs.
    pub coefficients: Vec<f64>,
    /// Standard errors of predictions at 0 and at 10. Between these, the standard error is interpolated linearly.
    pub standard_errors: [f64; 2],
    /// Share of the variance between worlds of the atlas that is explained by predictions of worlds that were left
    /// out of the fit.
    pub explained: f64,
}

/// Models of all dials with the same inputs. They are checked when they are read from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedModels")]
pub struct DialModels {
    /// The inputs.
    pub inputs: Vec<Input>,
    /// The models.
    pub models: Dials<LinearModel>,
}

/// Models as they are read from a file, before they are checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedModels {
    inputs: Vec<Input>,
    models: Dials<LinearModel>,
}

impl TryFrom<UncheckedModels> for DialModels {
    type Error = SpecError;

    fn try_from(UncheckedModels { inputs, models }: UncheckedModels) -> Result<Self, SpecError> {
        for (dial, model) in models.as_ref().named() {
            model.check(&inputs).map_err(|error| error.within(dial))?;
        }
        Ok(DialModels { inputs, models })
    }
}

impl Input {
    /// Returns the logarithm `ln(1 + value / scale)`.
    pub fn logarithm(value: f64, scale: f64) -> f64 {
        libm::log1p(value.max(0.0) / scale)
    }

    /// Returns a value in standard deviations from the mean, clamped to the range of the atlas, and whether it was
    /// clamped.
    ///
    /// # Panics
    /// When the least of the range is above the greatest, or one of them is NaN. No file gives such an input.
    #[track_caller]
    pub fn standardised(&self, value: Option<f64>) -> (f64, bool) {
        let Some(value) = value.filter(|value| value.is_finite()) else { return (0.0, false) };
        let [least, most] = self.range;
        let log = Input::logarithm(value, self.scale);
        let inside = log.clamp(least, most);
        let is_cut = (log - inside).abs() > ROUNDING * self.deviation;
        ((inside - self.mean) / self.deviation, is_cut)
    }
}

impl LinearModel {
    /// Checks a model of given inputs: all that it predicts must be finite.
    fn check(&self, inputs: &[Input]) -> Result<(), SpecError> {
        let refused = |field: &str, value: &dyn fmt::Display, allowed: &str| {
            Err(SpecError::new(field, value, allowed))
        };
        let (given, wanted) = (self.coefficients.len(), inputs.len());
        if given != wanted {
            let allowed = format!("a list of {wanted}, one for each input");
            return refused("coefficients", &format!("a list of {given}"), &allowed);
        }
        // The distance of the farthest prediction from 0 is at most the sum of the terms' distances.
        let terms = self.coefficients.iter().zip(inputs).map(|(slope, input)| {
            let most = input.range.map(|end| ((end - input.mean) / input.deviation).abs());
            (slope * most[0]).abs().max((slope * most[1]).abs())
        });
        let farthest = terms.fold(self.intercept.abs(), |sum, term| sum + term);
        if !farthest.is_finite() {
            let allowed = "numbers that give finite predictions over the ranges of the inputs";
            return refused("coefficients", &format!("predictions up to {farthest}"), allowed);
        }
        for error in self.standard_errors {
            if !(error >= 0.0 && error.is_finite()) {
                return refused("standard_errors", &error, "two finite numbers of at least 0");
            }
        }
        if !(self.explained <= 1.0 && self.explained.is_finite()) {
            return refused("explained", &self.explained, "a finite number of at most 1");
        }
        Ok(())
    }

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

    /// Returns how far a value lies below the range of an input: 0 in the range, 1 from [`FADE`] below it, and a number
    /// between them between. Inputs that the models do not have, and values that are missing, are not below.
    pub(super) fn share_below(&self, name: &str, value: Option<f64>) -> f64 {
        let input = self.inputs.iter().find(|input| input.name == name);
        let Some((input, value)) = input.zip(value.filter(|value| value.is_finite())) else {
            return 0.0;
        };
        let below = (input.range[0] - Input::logarithm(value, input.scale)) / input.deviation;
        ((below - ROUNDING) / FADE).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

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

    fn read<T: serde::de::DeserializeOwned>(value: serde_json::Value) -> Result<T, String> {
        serde_json::from_value(value).map_err(|error| error.to_string())
    }

    #[test]
    fn inputs_without_meaning_are_refused() {
        let good = serde_json::to_value(&models().inputs[0]).unwrap();
        assert_eq!(read::<Input>(good.clone()).as_ref(), Ok(&models().inputs[0]));
        let positive = "a positive finite number";
        let ends = "two finite numbers, the least first";
        for (field, value, allowed, got) in [
            ("scale", json!(0.0), positive, "0"),
            ("scale", json!(-2.0), positive, "-2"),
            ("deviation", json!(0.0), positive, "0"),
            ("deviation", json!(-0.5), positive, "-0.5"),
            ("range", json!([2.0, 0.5]), ends, "2 and 0.5"),
        ] {
            let mut wrong = good.clone();
            wrong[field] = value;
            let expected = format!("`a.{field}` must be {allowed}, got {got}");
            assert_eq!(read::<Input>(wrong), Err(expected));
        }
        let mut other = good;
        other["median"] = json!(1.0);
        assert!(read::<Input>(other).unwrap_err().contains("unknown field `median`"));
        // Other formats than JSON have numbers that are not finite.
        let text = |mean, most| {
            format!("(name:\"a\",scale:1.0,mean:{mean},deviation:0.5,range:(0.0,{most}))")
        };
        assert_eq!(ron::from_str::<Input>(&text("1.0", "2.0")), Ok(models().inputs[0].clone()));
        for (mean, most, field) in
            [("NaN", "2.0", "mean"), ("1.0", "inf", "range"), ("1.0", "NaN", "range")]
        {
            let error = ron::from_str::<Input>(&text(mean, most)).unwrap_err().to_string();
            assert!(error.contains(&format!("`a.{field}` must be")), "{error}");
        }
    }

    #[test]
    fn models_that_do_not_fit_their_inputs_are_refused() {
        let good = serde_json::to_value(models()).unwrap();
        assert_eq!(read::<DialModels>(good.clone()), Ok(models()));
        let finite = "numbers that give finite predictions over the ranges of the inputs";
        let one_each = "a list of 2, one for each input";
        let errors = "two finite numbers of at least 0";
        for (dial, field, value, allowed, got) in [
            ("difficulty", "coefficients", json!([2.0]), one_each, "a list of 1"),
            ("mapping", "coefficients", json!([]), one_each, "a list of 0"),
            ("navigation", "coefficients", json!([1.0, 2.0, 3.0]), one_each, "a list of 3"),
            ("mapping", "coefficients", json!([1.0, 1e308]), finite, "predictions up to inf"),
            ("navigation", "standard_errors", json!([0.5, -1.0]), errors, "-1"),
            ("difficulty", "explained", json!(1.5), "a finite number of at most 1", "1.5"),
        ] {
            let mut wrong = good.clone();
            wrong["models"][dial][field] = value;
            let expected = format!("`{dial}.{field}` must be {allowed}, got {got}");
            assert_eq!(read::<DialModels>(wrong), Err(expected));
        }
        let mut other = good;
        other["outputs"] = json!([]);
        assert!(read::<DialModels>(other).unwrap_err().contains("unknown field `outputs`"));
    }

    proptest! {
        #[test]
        fn what_is_read_predicts_finite_numbers(
            scale in numbers(), mean in numbers(), deviation in numbers(),
            ends in [numbers(), numbers()], slopes in prop::collection::vec(numbers(), 0..4),
            errors in [numbers(), numbers()], value in numbers(),
        ) {
            let mut models = models();
            let input = Input { scale, mean, deviation, range: ends, ..models.inputs[0].clone() };
            models.inputs[0] = input;
            models.models.difficulty.coefficients = slopes;
            models.models.mapping.standard_errors = errors;
            let json = serde_json::to_string(&models).unwrap();
            if let Ok(read) = serde_json::from_str::<DialModels>(&json) {
                prop_assert_eq!(&read, &models);
                let (dials, outside) = read.predict(&|_| Some(value));
                for (_, dial) in dials.named() {
                    prop_assert!(dial.value.is_finite());
                    prop_assert!(dial.standard_error >= 0.0 && dial.standard_error.is_finite());
                }
                prop_assert!((0.0..=1.0).contains(&outside));
            }
        }
    }

    /// Mostly ordinary numbers.
    fn numbers() -> impl Strategy<Value = f64> {
        prop_oneof![8 => 0.1..3.0_f64, 1 => -2.0..0.0_f64, 1 => Just(0.0), 1 => any::<f64>()]
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
