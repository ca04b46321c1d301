//! Fits the models of a calibration to an atlas.

use envgen::calibration::{Atlas, Calibration, DialModels, Dials, Input, LinearModel, Scale};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::{World, WorldKind, WorldSpec};
use thiserror::Error;

use super::ridge;

/// Least standard deviation of an input in the atlas. Inputs that vary less are left out.
const LEAST_DEVIATION: f64 = 1e-6;

/// Least standard error of a prediction.
const LEAST_ERROR: f64 = 0.1;

/// A measured world of an atlas, with what predictions can use.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The features of its difficulty vector, in order.
    pub features: Vec<Option<f64>>,
    /// The terms of its settings; empty for kinds that are not drawn by difficulty.
    pub terms: Vec<(&'static str, f64)>,
    /// Its measured dials.
    pub dials: Dials<f64>,
}

impl Sample {
    /// Creates the sample of a measured world.
    ///
    /// # Errors
    ///
    /// If the world has no difficulty vector.
    pub fn new(
        spec: &WorldSpec,
        world: &World,
        dials: Dials<f64>,
    ) -> Result<Self, envgen::difficulty::DifficultyError> {
        let vector = DifficultyVector::of(world, &Platform::default())?;
        let terms = match spec {
            WorldSpec::Indoor(spec) => spec.lever_terms(),
            _ => Vec::new(),
        };
        Ok(Sample { features: vector.values(), terms, dials })
    }
}

/// Least number of samples to which models are fitted: one for each fold of the cross-validation.
pub const LEAST_SAMPLES: usize = ridge::FOLDS;

/// The error that there are too few samples for a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("expected at least {LEAST_SAMPLES} worlds whose trials are all finished, got {0}")]
pub struct TooFewSamples(pub usize);

/// Fits all models to the samples of an atlas of worlds of one kind. The version is to be another one than that of any
/// calibration that predicts other values: see [`AtlasDesign::version`](super::AtlasDesign::version).
///
/// # Errors
///
/// If there are fewer than [`LEAST_SAMPLES`].
pub fn calibrate(
    version: u32,
    kind: WorldKind,
    atlas: Atlas,
    scale: Scale,
    samples: &[Sample],
) -> Result<Calibration, TooFewSamples> {
    if samples.len() < LEAST_SAMPLES {
        return Err(TooFewSamples(samples.len()));
    }
    let names = DifficultyVector::features();
    let features = names.iter().enumerate().map(|(i, feature)| {
        (feature.name, samples.iter().map(|sample| sample.features[i]).collect())
    });
    let terms = samples.first().map_or(&[][..], |sample| &sample.terms);
    let terms = terms.iter().enumerate().map(|(i, (name, _))| {
        (*name, samples.iter().map(|sample| Some(sample.terms[i].1)).collect())
    });
    let dials: Vec<Dials<f64>> = samples.iter().map(|sample| sample.dials).collect();
    let atlas = Atlas { worlds: samples.len() as u32, dials: sorted(&dials), ..atlas };
    Ok(Calibration {
        version,
        kind: kind.name().to_owned(),
        atlas,
        scale,
        world: models(features, &dials),
        settings: (terms.len() > 0).then(|| models(terms, &dials)),
        smaller: None,
    })
}

/// The values of each dial in order, rounded to a hundredth.
fn sorted(dials: &[Dials<f64>]) -> Dials<Vec<f64>> {
    let values = |of: fn(&Dials<f64>) -> f64| {
        let mut all: Vec<f64> = dials.iter().map(|one| (100.0 * of(one)).round() / 100.0).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    Dials {
        difficulty: values(|dials| dials.difficulty),
        mapping: values(|dials| dials.mapping),
        navigation: values(|dials| dials.navigation),
    }
}

/// Fits models of all dials to columns of inputs, which have one value per sample.
fn models<'a>(
    columns: impl Iterator<Item = (&'a str, Vec<Option<f64>>)>,
    dials: &[Dials<f64>],
) -> DialModels {
    let mut rows = vec![Vec::new(); dials.len()];
    let mut inputs = Vec::new();
    for (name, values) in columns {
        let Some(input) = input(name, &values) else { continue };
        for (row, value) in rows.iter_mut().zip(values) {
            row.push(input.standardised(value).0);
        }
        inputs.push(input);
    }
    let model =
        |of: fn(&Dials<f64>) -> f64| linear_model(&rows, &dials.iter().map(of).collect::<Vec<_>>());
    let models = Dials {
        difficulty: model(|dials| dials.difficulty),
        mapping: model(|dials| dials.mapping),
        navigation: model(|dials| dials.navigation),
    };
    DialModels { inputs, models }
}

/// The distribution of an input; `None` if it does not vary.
fn input(name: &str, values: &[Option<f64>]) -> Option<Input> {
    let mut known: Vec<f64> = values.iter().flatten().copied().filter(|v| *v > 0.0).collect();
    known.sort_by(f64::total_cmp);
    let scale = *known.get(known.len() / 2)?;
    let logs: Vec<f64> = values.iter().flatten().map(|&v| Input::logarithm(v, scale)).collect();
    let n = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / n;
    let squares: f64 = logs.iter().map(|log| (log - mean) * (log - mean)).sum();
    let deviation = (squares / n).sqrt();
    let range = logs.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &log| {
        [least.min(log), most.max(log)]
    });
    let varies = deviation > LEAST_DEVIATION;
    varies.then(|| Input { name: name.to_owned(), scale, mean, deviation, range })
}

fn linear_model(rows: &[Vec<f64>], values: &[f64]) -> LinearModel {
    let fitted = ridge::fit(rows, values);
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let spread = ridge::squared_error(&vec![mean; values.len()], values);
    let error = ridge::squared_error(&fitted.left_out, values);
    LinearModel {
        standard_errors: standard_errors(&fitted.left_out, values),
        explained: if spread > 0.0 { 1.0 - error / spread } else { 0.0 },
        intercept: fitted.intercept,
        coefficients: fitted.coefficients,
    }
}

/// The standard errors at 0 and at 10, from the line of least squares through the absolute errors over the predictions,
/// among the lines that are at least [`LEAST_ERROR`] at both.
fn standard_errors(predicted: &[f64], values: &[f64]) -> [f64; 2] {
    // The mean absolute value of a normal number is its deviation times the root of 2 / pi.
    let to_deviation = (0.5 * std::f64::consts::PI).sqrt();
    let errors: Vec<f64> =
        predicted.iter().zip(values).map(|(a, b)| to_deviation * (a - b).abs()).collect();
    let n = errors.len().max(1) as f64;
    let (x, y) = (predicted.iter().sum::<f64>() / n, errors.iter().sum::<f64>() / n);
    let xx: f64 = predicted.iter().map(|p| (p - x) * (p - x)).sum();
    let xy: f64 = predicted.iter().zip(&errors).map(|(p, e)| (p - x) * (e - y)).sum();
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let [zero, ten] = [0.0, 10.0].map(|at| y + slope * (at - x));
    // Where the line is too low at one end, that end is fixed and the other is the best for it.
    let pinned = |share: &dyn Fn(f64) -> f64| {
        // Beyond 0 and 10 they are those of the ends.
        let parts = predicted.iter().zip(&errors).map(|(p, e)| (share(p.clamp(0.0, 10.0)), *e));
        let (squares, products) = parts.fold((0.0, 0.0), |(squares, products), (share, error)| {
            let rest = error - LEAST_ERROR * (1.0 - share);
            (squares + share * share, products + share * rest)
        });
        let other = if squares > 0.0 { products / squares } else { LEAST_ERROR };
        other.max(LEAST_ERROR)
    };
    if zero.min(ten) >= LEAST_ERROR {
        [zero, ten]
    } else if zero < ten {
        [LEAST_ERROR, pinned(&|p| 0.1 * p)]
    } else {
        [pinned(&|p| 1.0 - 0.1 * p), LEAST_ERROR]
    }
}

#[cfg(test)]
mod tests {
    use envgen::indoor::IndoorSpec;
    use envgen::{Blueprint, Seed, Spec};

    use super::*;

    /// Small maps whose dials follow from one feature and one term.
    fn samples() -> Vec<Sample> {
        let base = IndoorSpec { width: 5, height: 5, ..Default::default() };
        let place = |name: &str| {
            DifficultyVector::features().iter().position(|f| f.name == name).expect("a feature")
        };
        let area = place("reachable_area_m2");
        let sample = |seed: u64| {
            let spec = base.draw_levers(Seed(seed));
            let world = spec.generate(Seed(seed)).expect("a plan").to_world();
            let mut sample =
                Sample::new(&spec.clone().into(), &world, Dials::default()).expect("a vector");
            let mapping = 0.3 * libm::log(sample.features[area].expect("an area"));
            sample.dials = Dials { difficulty: 5.0, mapping, navigation: spec.doorway };
            sample
        };
        (0..60).map(sample).collect()
    }

    #[test]
    fn models_predict_what_they_were_fitted_to() {
        let atlas = Atlas {
            command: String::new(),
            worlds: 60,
            trials: 0,
            digest: String::new(),
            dials: Dials::default(),
        };
        let zero = Dials::default();
        let scale = Scale {
            panel: "test".to_owned(),
            panel_version: 1,
            anchors_version: 1,
            zero,
            ten: zero.map(|_| 10.0),
        };
        let samples = samples();
        let few = &samples[..LEAST_SAMPLES - 1];
        let error = calibrate(4, WorldKind::Indoor, atlas.clone(), scale.clone(), few).unwrap_err();
        assert_eq!(error, TooFewSamples(9));
        let calibration = calibrate(4, WorldKind::Indoor, atlas, scale, &samples).unwrap();
        let explained = calibration.world.models.as_ref().map(|model| model.explained);
        assert!(explained.mapping > 0.95, "{explained:?}");
        // The widths of doorways are settings.
        assert!(calibration.settings.as_ref().expect("models").models.navigation.explained > 0.95);
        let text = serde_json::to_string(&calibration).expect("JSON");
        let measured = &calibration.atlas.dials.mapping;
        assert!(measured.len() == 60 && measured.is_sorted());
        assert_eq!(serde_json::from_str::<Calibration>(&text).expect("the same"), calibration);
    }

    #[test]
    fn standard_errors_are_those_of_predictions_that_are_off_the_more_the_greater_they_are() {
        let mut draws = Seed(5).stream("errors", 0);
        // Normal numbers by sums of twelve uniform ones.
        let mut normal = || (0..12).map(|_| draws.unit()).sum::<f64>() - 6.0;
        for (deviation, range) in [
            ((|p| 0.02 + 0.08 * p) as fn(f64) -> f64, [3.0, 7.0]),
            // Nothing at one end of the range, and less than that beyond.
            (|p| 0.2 * (p - 2.0), [2.0, 6.0]),
            (|p| 0.2 * (8.0 - p), [4.0, 8.0]),
            (|_| 0.3, [0.0, 10.0]),
            (|_| 0.01, [0.0, 10.0]),
        ] {
            let at = |k: u32| range[0] + (range[1] - range[0]) * f64::from(k) / 999.0;
            let predicted: Vec<f64> = (0..1000).map(at).collect();
            let values: Vec<f64> = predicted.iter().map(|&p| p + deviation(p) * normal()).collect();
            let [zero, ten] = standard_errors(&predicted, &values);
            assert!(zero >= LEAST_ERROR && ten >= LEAST_ERROR, "{zero} {ten}");
            let mean = |of: &dyn Fn(f64) -> f64| {
                predicted.iter().map(|&p| of(p)).sum::<f64>() / predicted.len() as f64
            };
            let (stated, true_error) = (mean(&|p| zero + 0.1 * p * (ten - zero)), mean(&deviation));
            // A line that is cut at one end alone is 1.75 times as high in the second case. The mean of 1000 absolute
            // errors deviates by about 3 % at random.
            let most = (1.2 * true_error).max(LEAST_ERROR + 1e-9);
            assert!(
                (0.85 * true_error..=most).contains(&stated),
                "{zero} {ten}: {stated}, {true_error}"
            );
        }
    }
}
