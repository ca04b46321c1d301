//! Predicted difficulty: how difficult a world is on the scale of mapping trials, without simulation.
//!
//! The crate `mapping_trial` measures the difficulty of a world by trials of a panel of robots, on a scale whose
//! values 0 and 10 are defined by sets of reference worlds. Linear models (ridge regression) of three dials are
//! fitted to an *atlas* of measured worlds: the difficulty `d`, and its two aspects, mapping `m` and navigation
//! `n`. A [`Calibration`] holds models from the [difficulty vector](crate::difficulty) of a world, and models from
//! the settings alone, which are used to choose what to generate. Predictions are the same to the last bit on every
//! platform.
//!
//! ```
//! use envgen::calibration::Calibration;
//! use envgen::difficulty::{DifficultyVector, Platform};
//! use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
//!
//! let spec = IndoorSpec { width: 8, height: 8, ..Default::default() };
//! let world = spec.generate(Seed(7))?.to_world();
//! let vector = DifficultyVector::of(&world, &Platform::default())?;
//! let prediction = Calibration::indoor().predict(&vector);
//! assert!(prediction.dials.difficulty.value < 6.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod linear;
mod scale;

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

pub use linear::{DialModels, Input, LinearModel};
pub use scale::Scale;

pub use crate::dials::{Dials, Estimate, Prediction};

use crate::difficulty::DifficultyVector;
use crate::error::SpecError;
use crate::kind::WorldKind;
use crate::world::World;

/// The calibrations that are part of this crate.
static INDOOR: LazyLock<Calibration> = LazyLock::new(|| Calibration {
    smaller: Some(Box::new(parse(include_str!("indoor_small.json")))),
    ..parse(include_str!("indoor.json"))
});
static HALLWAY: LazyLock<Calibration> = LazyLock::new(|| parse(include_str!("hallway.json")));
static FOREST: LazyLock<Calibration> = LazyLock::new(|| parse(include_str!("forest.json")));

/// Parses a calibration that is part of the crate, which tests check.
fn parse(text: &str) -> Calibration {
    serde_json::from_str(text).expect("the file is a calibration")
}

/// Models that predict difficulty, with the scale and the atlas on which they are based. A calibration that is read
/// from a file predicts finite numbers: its parts are checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the calibration. Another version predicts other values.
    pub version: u32,
    /// The kind of worlds for which it is made.
    pub kind: String,
    /// The atlas to which it was fitted.
    pub atlas: Atlas,
    /// The scale of its dials.
    pub scale: Scale,
    /// Models from the difficulty vector of a world.
    pub world: DialModels,
    /// Models from settings; `None` for kinds that are not drawn by difficulty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<DialModels>,
    /// The calibration of worlds that are smaller than those of the atlas, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smaller: Option<Box<Calibration>>,
}

/// The measured worlds to which a calibration was fitted. It is checked when it is read from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UncheckedAtlas")]
pub struct Atlas {
    /// The command that ran the trials.
    pub command: String,
    /// Number of worlds.
    pub worlds: u32,
    /// Number of trials.
    pub trials: u32,
    /// SHA-256 of the results of the trials.
    pub digest: String,
    /// The measured dials of the worlds, each dial sorted: one of each world, or none at all.
    #[serde(default)]
    pub dials: Dials<Vec<f64>>,
}

/// An atlas as it is read from a file, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct UncheckedAtlas {
    command: String,
    worlds: u32,
    trials: u32,
    digest: String,
    #[serde(default)]
    dials: Dials<Vec<f64>>,
}

impl TryFrom<UncheckedAtlas> for Atlas {
    type Error = SpecError;

    fn try_from(read: UncheckedAtlas) -> Result<Self, SpecError> {
        let UncheckedAtlas { command, worlds, trials, digest, dials } = read;
        let is_measured = dials.as_ref().named().iter().any(|(_, all)| !all.is_empty());
        for (dial, all) in dials.as_ref().named() {
            let refused = |given: String, allowed: &str| {
                Err(SpecError::new(dial, given, allowed).within("dials"))
            };
            if is_measured && all.len() as u64 != u64::from(worlds) {
                let allowed = format!("a list of {worlds}, one for each world, as the other dials");
                return refused(format!("a list of {}", all.len()), &allowed);
            }
            if let Some(wrong) = all.iter().find(|value| !value.is_finite()) {
                return refused(wrong.to_string(), "finite numbers");
            }
            if let Some(pair) = all.windows(2).find(|pair| pair[0] > pair[1]) {
                return refused(format!("{} before {}", pair[0], pair[1]), "sorted");
            }
        }
        Ok(Atlas { command, worlds, trials, digest, dials })
    }
}

impl Atlas {
    /// Returns, for each dial, the percentage of the atlas's worlds that measure less than the given value, where
    /// worlds that measure the same count half; `None` if the atlas lacks the measured values of some dial.
    pub fn percentiles(&self, dials: Dials<f64>) -> Option<Dials<f64>> {
        let is_measured = self.dials.as_ref().named().iter().all(|(_, all)| !all.is_empty());
        let percentile = |(all, value): (&Vec<f64>, f64)| {
            let below = all.partition_point(|one| *one < value);
            let upto = all.partition_point(|one| *one <= value);
            50.0 * (below + upto) as f64 / all.len() as f64
        };
        is_measured.then(|| self.dials.as_ref().zip(dials).map(percentile))
    }
}

impl Calibration {
    /// Returns the calibration of indoor maps, for the reference panel of `mapping_trial`.
    pub fn indoor() -> &'static Calibration {
        &INDOOR
    }

    /// Returns the calibration of a kind of world, by its [name](WorldKind::name); `None` for kinds that have none.
    /// For worlds of other tools, most of which are buildings, it returns the calibration of indoor maps.
    pub fn of(kind: &str) -> Option<&'static Calibration> {
        match WorldKind::named(kind) {
            Some(WorldKind::Indoor) | None => Some(&INDOOR),
            Some(WorldKind::Hallway) => Some(&HALLWAY),
            Some(WorldKind::Forest) => Some(&FOREST),
            Some(_) => None,
        }
    }

    /// Returns the calibration of a world's kind, also for a world that was written to a file of another format and
    /// read again.
    pub fn of_world(world: &World) -> Option<&'static Calibration> {
        Calibration::of(&world.provenance.original().kind)
    }

    /// Predicts the difficulty of a world from its difficulty vector.
    ///
    /// For a world whose ground is smaller than that of all worlds of the atlas, the prediction is that of the
    /// calibration of [smaller](Self::smaller) worlds. Between the two sizes it passes from one to the other. The
    /// prediction has the version of the calibration of smaller worlds wherever that has a part in it.
    ///
    /// ```
    /// use envgen::calibration::Calibration;
    /// use envgen::difficulty::{DifficultyVector, Platform};
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    ///
    /// let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// let vector = DifficultyVector::of(&world, &Platform::default())?;
    /// let prediction = Calibration::indoor().predict(&vector);
    /// // The dials have standard errors.
    /// let [low, high] = prediction.dials.difficulty.interval();
    /// assert!(low < prediction.dials.difficulty.value && prediction.dials.difficulty.value < high);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn predict(&self, vector: &DifficultyVector) -> Prediction {
        self.mixed("ground_area_m2", &|of| Some(&of.world), &|name| vector.get(name))
            .unwrap_or_else(|| unreachable!("every calibration has models of worlds"))
    }

    /// Predicts the difficulty of the worlds that settings give, from the [`terms`](Input) of the settings; `None`
    /// for kinds that are not drawn by difficulty.
    pub(crate) fn predict_terms(&self, terms: &[(&str, f64)]) -> Option<Prediction> {
        let value = |name: &str| terms.iter().find(|(term, _)| *term == name).map(|(_, v)| *v);
        self.mixed("area_m2", &|of| of.settings.as_ref(), &value)
    }

    /// The prediction by the models that `models` returns, mixed with that of smaller worlds where the area, the input
    /// of the given name, is below those of the atlas.
    fn mixed(
        &self,
        area: &str,
        models: &dyn Fn(&Calibration) -> Option<&DialModels>,
        value: &dyn Fn(&str) -> Option<f64>,
    ) -> Option<Prediction> {
        let own = models(self)?;
        let alone = || {
            let (dials, outside) = own.predict(value);
            Prediction { calibration: self.version, dials, outside }
        };
        let share = own.share_below(area, value(area));
        let smaller = self.smaller.as_ref().filter(|_| share > 0.0);
        let Some(small) = smaller.and_then(|of| of.mixed(area, models, value)) else {
            return Some(alone());
        };
        Some(if share < 1.0 { alone().mixed(&small, share) } else { small })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_calibration_is_of_its_kind() {
        for kind in WorldKind::ALL {
            let of = Calibration::of(kind.name());
            let is_calibrated =
                matches!(kind, WorldKind::Indoor | WorldKind::Hallway | WorldKind::Forest);
            assert_eq!(of.map(|found| found.kind.as_str()), is_calibrated.then_some(kind.name()));
            let Some(found) = of else { continue };
            assert!(found.world.models.difficulty.explained > 0.5, "{kind}");
            assert_eq!(found.settings.is_some(), *kind == WorldKind::Indoor);
            let scale = &Calibration::indoor().scale;
            assert_eq!(&found.scale, scale, "{kind} is on another scale");
        }
        assert_eq!(Calibration::of("a tool").map(|found| found.kind.as_str()), Some("indoor"));
    }

    #[test]
    fn smaller_worlds_are_smaller_and_on_the_same_scale() {
        let indoor = Calibration::indoor();
        let small = indoor.smaller.as_deref().expect("small indoor maps are calibrated");
        assert_eq!((&small.kind, &small.scale), (&indoor.kind, &indoor.scale));
        assert_ne!(small.version, indoor.version);
        let least = |of: &Calibration, name: &str| {
            let models = [Some(&of.world), of.settings.as_ref()].into_iter().flatten();
            let mut inputs = models.flat_map(|models| &models.inputs);
            let input = inputs.find(|input| input.name == name).expect("an area");
            input.scale * libm::expm1(input.range[0])
        };
        for name in ["ground_area_m2", "area_m2"] {
            assert!(least(small, name) < 0.5 * least(indoor, name), "{name}");
        }
        let json = serde_json::to_value(indoor).unwrap();
        assert_eq!(serde_json::from_value::<Calibration>(json).as_ref().ok(), Some(indoor));
    }

    /// A calibration whose dials are constant, for areas from `least` on.
    fn constant(version: u32, value: f64, least: f64) -> Calibration {
        let [low, high] = [least, 1000.0].map(|area| Input::logarithm(area, 100.0));
        let model = json!({
            "intercept": value, "coefficients": [0.0], "explained": 0.5,
            "standard_errors": [0.1 * value, 0.1 * value],
        });
        let models = |name: &str| {
            json!({
                "inputs": [{
                    "name": name, "scale": 100.0, "mean": 0.0, "deviation": 0.5, "range": [low, high],
                }],
                "models": {"difficulty": model, "mapping": model, "navigation": model},
            })
        };
        let calibration = json!({
            "version": version, "kind": "indoor", "scale": Calibration::indoor().scale,
            "atlas": {"command": "atlas", "worlds": 1, "trials": 1, "digest": "0"},
            "world": models("ground_area_m2"), "settings": models("area_m2"),
        });
        serde_json::from_value(calibration).expect("a calibration")
    }

    #[test]
    fn predictions_pass_to_those_of_smaller_worlds() {
        let mut calibration = constant(2, 6.0, 400.0);
        let predicted = |calibration: &Calibration, area: f64| {
            calibration.predict_terms(&[("area_m2", area)]).expect("a prediction")
        };
        let alone = predicted(&calibration, 150.0);
        assert_eq!((alone.calibration, alone.dials.difficulty.value, alone.outside), (2, 6.0, 1.0));
        calibration.smaller = Some(Box::new(constant(3, 4.0, 100.0)));
        for area in [400.0, 900.0, 2000.0] {
            let found = predicted(&calibration, area);
            assert_eq!((found.calibration, found.dials.mapping.value), (2, 6.0), "{area}");
        }
        for area in [1.0, 100.0, 340.0] {
            let found = predicted(&calibration, area);
            let Estimate { value, standard_error } = found.dials.navigation;
            assert_eq!((found.calibration, value, standard_error), (3, 4.0, 0.4), "{area}");
            assert_eq!(found.outside, f64::from(u8::from(area < 100.0)));
        }
        // No step between the two sizes is a jump.
        let areas = (0..=600).map(|i| 340.0 + 0.1 * f64::from(i));
        let found: Vec<f64> =
            areas.map(|area| predicted(&calibration, area).dials.difficulty.value).collect();
        assert!(found.is_sorted() && found[0] == 4.0 && found[600] == 6.0);
        assert!(found.windows(2).all(|pair| pair[1] - pair[0] < 0.02));
        // Without an area, or without models, nothing is known of a size.
        assert_eq!(calibration.predict_terms(&[]).map(|found| found.calibration), Some(2));
        calibration.smaller.as_mut().expect("smaller worlds").settings = None;
        assert_eq!(predicted(&calibration, 150.0), alone);
    }

    #[test]
    fn percentiles_count_worlds_below() {
        let sorted = vec![1.0, 2.0, 2.0, 5.0];
        let dials =
            Dials { difficulty: sorted.clone(), mapping: sorted.clone(), navigation: sorted };
        let mut atlas = Calibration::indoor().atlas.clone();
        atlas.dials = dials;
        let at = |difficulty: f64, mapping: f64, navigation: f64| {
            atlas.percentiles(Dials { difficulty, mapping, navigation }).expect("an atlas").named()
        };
        assert_eq!(at(0.0, 2.0, 9.0).map(|(_, value)| value), [0.0, 50.0, 100.0]);
        assert_eq!(at(1.0, 3.0, 5.0).map(|(_, value)| value), [12.5, 75.0, 87.5]);
        for empty in [0, 1, 2] {
            let mut some = atlas.clone();
            let Dials { difficulty, mapping, navigation } = &mut some.dials;
            [difficulty, mapping, navigation][empty].clear();
            assert_eq!(some.percentiles(Dials::default()), None);
        }
        atlas.dials = Dials::default();
        assert_eq!(atlas.percentiles(Dials::default()), None);
    }

    #[test]
    fn atlases_that_are_not_of_their_worlds_are_refused() {
        let read = |change: &dyn Fn(&mut serde_json::Value)| {
            let sorted = json!([1.0, 2.0, 2.0]);
            let mut atlas = json!({
                "command": "atlas", "worlds": 3, "trials": 9, "digest": "0",
                "dials": {"difficulty": sorted, "mapping": sorted, "navigation": sorted},
            });
            change(&mut atlas);
            serde_json::from_value::<Atlas>(atlas).map_err(|error| error.to_string())
        };
        assert!(read(&|_| {}).is_ok());
        let none = |atlas: &mut serde_json::Value| {
            atlas.as_object_mut().unwrap().remove("dials");
        };
        assert_eq!(read(&none).map(|atlas| atlas.dials), Ok(Dials::default()));
        let each = "a list of 3, one for each world, as the other dials";
        for (dial, values, allowed, got) in [
            ("mapping", json!([]), each, "a list of 0"),
            ("difficulty", json!([]), each, "a list of 0"),
            ("navigation", json!([1.0, 2.0]), each, "a list of 2"),
            ("mapping", json!([1.0, 3.0, 2.0]), "sorted", "3 before 2"),
        ] {
            let error = read(&|atlas| atlas["dials"][dial] = values.clone()).unwrap_err();
            assert_eq!(error, format!("`dials.{dial}` must be {allowed}, got {got}"));
        }
        let other = |atlas: &mut serde_json::Value| atlas["maps"] = json!(3);
        assert!(read(&other).unwrap_err().contains("unknown field `maps`"));
    }

    #[test]
    fn files_are_written_as_they_were_read() {
        let (indoor, small) = (Calibration { smaller: None, ..INDOOR.clone() }, &INDOOR.smaller);
        for (calibration, text) in [
            (&indoor, include_str!("indoor.json")),
            (small.as_deref().expect("small maps"), include_str!("indoor_small.json")),
            (&*HALLWAY, include_str!("hallway.json")),
            (&*FOREST, include_str!("forest.json")),
        ] {
            let written = serde_json::to_string_pretty(calibration).unwrap() + "\n";
            assert!(written == text, "{}", calibration.kind);
        }
    }
}
