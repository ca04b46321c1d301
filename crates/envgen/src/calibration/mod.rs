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
use crate::kind::WorldKind;
use crate::world::World;

/// The calibrations that are part of this crate.
static INDOOR: LazyLock<Calibration> = LazyLock::new(|| parse(include_str!("indoor.json")));
static HALLWAY: LazyLock<Calibration> = LazyLock::new(|| parse(include_str!("hallway.json")));
static FOREST: LazyLock<Calibration> = LazyLock::new(|| parse(include_str!("forest.json")));

/// Parses a calibration that is part of the crate, which tests check.
fn parse(text: &str) -> Calibration {
    serde_json::from_str(text).expect("the file is a calibration")
}

/// Models that predict difficulty, with the scale and the atlas on which they are based.
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
}

/// The measured worlds to which a calibration was fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Atlas {
    /// The command that ran the trials.
    pub command: String,
    /// Number of worlds.
    pub worlds: u32,
    /// Number of trials.
    pub trials: u32,
    /// SHA-256 of the results of the trials.
    pub digest: String,
    /// The measured dials of the worlds, each dial sorted.
    #[serde(default)]
    pub dials: Dials<Vec<f64>>,
}

impl Atlas {
    /// Returns, for each dial, the percentage of the atlas's worlds that measure less than the given value, where
    /// worlds that measure the same count half; `None` if the atlas has no measured dials.
    pub fn percentiles(&self, dials: Dials<f64>) -> Option<Dials<f64>> {
        let is_empty = self.dials.difficulty.is_empty();
        let percentile = |(all, value): (&Vec<f64>, f64)| {
            let below = all.partition_point(|one| *one < value);
            let upto = all.partition_point(|one| *one <= value);
            50.0 * (below + upto) as f64 / all.len() as f64
        };
        (!is_empty).then(|| self.dials.as_ref().zip(dials).map(percentile))
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
        self.prediction(&self.world, &|name| vector.get(name))
    }

    /// Predicts the difficulty of the worlds that settings give, from the [`terms`](Input) of the settings; `None`
    /// for kinds that are not drawn by difficulty.
    pub(crate) fn predict_terms(&self, terms: &[(&str, f64)]) -> Option<Prediction> {
        let value = |name: &str| terms.iter().find(|(term, _)| *term == name).map(|(_, v)| *v);
        self.settings.as_ref().map(|settings| self.prediction(settings, &value))
    }

    fn prediction(&self, models: &DialModels, value: &dyn Fn(&str) -> Option<f64>) -> Prediction {
        let (dials, outside) = models.predict(value);
        Prediction { calibration: self.version, dials, outside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        atlas.dials = Dials::default();
        assert_eq!(atlas.percentiles(Dials::default()), None);
    }
}
