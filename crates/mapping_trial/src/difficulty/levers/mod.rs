//! The effect of each lever of a generator on the measured difficulty, at a fixed footprint.

mod figure;
mod lever;

use std::collections::BTreeMap;

use envgen::calibration::{Dials, Estimate, Scale};
use envgen::{Seed, SettingsError, SpecError, WorldSpec};
use serde::{Deserialize, Serialize};

pub use figure::figure;
pub use lever::{Lever, LeverLevel};

use super::measure::{mean, scores};
use crate::experiment::survey::{
    Condition, Family, Record, Survey, SurveyError, SurveyNoise, ron_options,
};

const FIRST: &str = include_str!("levers_1.ron");

/// A design for measuring levers: a spec, and levers with some values each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeverDesign {
    /// The spec with all other settings.
    pub spec: WorldSpec,
    /// The levers.
    pub levers: Vec<Lever>,
    /// The conditions of the trials, all with the same weight.
    pub conditions: Vec<Condition>,
    /// Number of worlds per value. All values have the same seeds.
    pub maps: u32,
    /// Seed of the first world.
    pub first_seed: Seed,
    /// Number of trials per world and condition.
    pub noise_seeds: u32,
}

impl LeverDesign {
    /// Returns the levers of indoor maps.
    ///
    /// # Panics
    ///
    /// Never: the file is part of the crate, and tested.
    pub fn first() -> Self {
        Self::from_ron(FIRST).expect("levers_1.ron has levers")
    }

    /// Reads levers from RON.
    ///
    /// # Errors
    ///
    /// Returns line and column of a syntax error, or that `maps` is below 2: a single world has no interval.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        let design: Self = ron_options().from_str(text).map_err(Box::new)?;
        if design.maps < 2 {
            let error = SpecError::new("maps", design.maps, "at least 2");
            return Err(SurveyError::Value { place: "levers".to_owned(), error });
        }
        Ok(design)
    }

    /// Returns the survey of all values of all levers.
    ///
    /// # Errors
    ///
    /// If a setting does not exist, or if a value is not allowed.
    pub fn survey(&self) -> Result<Survey, SettingsError> {
        let mut families = Vec::new();
        for lever in &self.levers {
            for value in &lever.values {
                let mut spec = self.spec.clone();
                for (name, value) in &lever.with {
                    spec.set(name, value)?;
                }
                spec.set(&lever.setting, &value.to_string())?;
                families.push(Family {
                    name: format!("{} {value}", lever.setting),
                    spec,
                    maps: self.maps,
                    first_seed: self.first_seed,
                });
            }
        }
        let (conditions, noise_seeds) = (self.conditions.clone(), self.noise_seeds);
        Ok(Survey { families, conditions, noise_seeds, noise: SurveyNoise::Shared })
    }

    /// Returns what the trials of the [survey](LeverDesign::survey) measured, lever by lever: the
    /// values for which at least two worlds have trials.
    pub fn levels<'a>(
        &self,
        scale: &Scale,
        records: impl IntoIterator<Item = &'a Record>,
    ) -> Vec<Vec<LeverLevel>> {
        let mut measured: BTreeMap<u32, Vec<Dials<f64>>> = BTreeMap::new();
        for record in records {
            measured.entry(record.map).or_default().extend(record.scores.as_ref().map(scores));
        }
        let mut first = 0;
        let mut level = |&value: &f64| {
            let maps = first..first + self.maps;
            first += self.maps;
            let own = maps.filter_map(|map| measured.get(&map).filter(|all| !all.is_empty()));
            let means: Vec<Dials<f64>> =
                own.map(|all| scale.dials(mean(all.iter().copied()))).collect();
            (means.len() > 1).then(|| LeverLevel {
                value,
                dials: Dials {
                    difficulty: estimate(means.iter().map(|dials| dials.difficulty)),
                    mapping: estimate(means.iter().map(|dials| dials.mapping)),
                    navigation: estimate(means.iter().map(|dials| dials.navigation)),
                },
                maps: means.len() as u32,
            })
        };
        let levers = self.levers.iter();
        levers.map(|lever| lever.values.iter().filter_map(&mut level).collect()).collect()
    }
}

/// Returns the mean of at least two values, with its standard error.
fn estimate(values: impl Iterator<Item = f64> + Clone) -> Estimate {
    let n = values.clone().count() as f64;
    let value = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|one| (one - value) * (one - value)).sum();
    Estimate { value, standard_error: (squares / (n - 1.0) / n).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::difficulty::reference_scale;
    use crate::score::Scores;

    #[test]
    fn every_value_is_allowed() {
        let design = LeverDesign::first();
        let survey = design.survey().expect("a survey");
        assert_eq!(survey.validate(), Ok(()));
        for family in &survey.families {
            family.spec.generate(family.first_seed).expect("a plan");
        }
        let mut wrong = design;
        wrong.levers[0].values = vec![0.0];
        let error = wrong.survey().expect_err("no survey").to_string();
        assert!(error.starts_with("`floor_slip` must be"), "{error}");
    }

    #[test]
    fn levels_are_the_means_over_worlds() {
        let lever = |setting: &str, values: &[f64]| Lever {
            setting: setting.to_owned(),
            unit: String::new(),
            with: BTreeMap::new(),
            values: values.to_vec(),
        };
        let levers = vec![lever("clutter", &[0.0, 9.0]), lever("mazes", &[0.5])];
        let design = LeverDesign { levers, maps: 2, ..LeverDesign::first() };
        let scale = reference_scale();
        let record = |map: u32, difficulty: f64| {
            let scores = Scores { difficulty, ..Default::default() };
            Record { map, scores: Some(scores), ..Record::default() }
        };
        let records =
            [record(0, 1.0), record(0, 2.0), record(1, 3.5), record(2, 1.0), record(5, 1.0)];
        let levels = design.levels(scale, &records);
        assert_eq!(levels.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0]);
        let found = levels[0][0];
        let expected = scale.units().difficulty * (2.5 - scale.zero.difficulty);
        assert!((found.dials.difficulty.value - expected).abs() < 1e-12, "{found:?}");
        let error = scale.units().difficulty;
        assert!((found.dials.difficulty.standard_error - error).abs() < 1e-12, "{found:?}");
    }
}
