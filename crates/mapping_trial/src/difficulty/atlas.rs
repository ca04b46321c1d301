//! Atlases: many worlds that were measured, from which predictions are fitted.

use std::collections::BTreeMap;

use envgen::calibration::{Dials, Scale};
use envgen::indoor::IndoorSpec;
use envgen::{Blueprint, Seed, Spec, WorldSpec};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::fit::Sample;
use super::measure::{mean, scores};
use super::panel::Panel;
use crate::experiment::survey::{Family, Record, Survey, SurveyError, SurveyMap, ron_options};
use crate::experiment::{ExperimentError, table};

const FIRST: &str = include_str!("atlas_1.ron");

/// Worlds of one kind of several sizes, whose levers are drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtlasDesign {
    /// Width and height in cells, with the number of worlds of that size.
    pub sizes: Vec<AtlasSize>,
    /// Seed of the first world.
    pub first_seed: Seed,
}

/// Worlds of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtlasSize {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Number of worlds.
    pub maps: u32,
}

impl AtlasDesign {
    /// The design of the atlas that the crate's calibration was fitted to.
    ///
    /// # Panics
    /// Never: the file is part of the crate, and tested.
    pub fn first() -> Self {
        Self::from_ron(FIRST).expect("atlas_1.ron is a design")
    }

    /// Reads a design from RON.
    ///
    /// # Errors
    /// Line and column of a mistake.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        Ok(ron_options().from_str(text).map_err(Box::new)?)
    }

    /// The survey of the atlas: every world under every condition once. Sizes take turns, so that a part of
    /// the survey has worlds of all sizes.
    pub fn survey(&self, panel: &Panel) -> Survey {
        let most = self.sizes.iter().map(|size| size.maps).max().unwrap_or(0);
        let mut families = Vec::new();
        for round in 0..most {
            for size in &self.sizes {
                // Evenly spread over the rounds.
                let (before, after) = (size.maps * round / most, size.maps * (round + 1) / most);
                if after == before {
                    continue;
                }
                let seed = self.first_seed.offset(families.len() as u64);
                let base =
                    IndoorSpec { width: size.width, height: size.height, ..Default::default() };
                families.push(Family {
                    name: format!("{} x {}, {seed}", size.width, size.height),
                    spec: WorldSpec::from(base.draw_levers(seed)),
                    maps: 1,
                    first_seed: seed,
                });
            }
        }
        Survey { families, conditions: panel.conditions.clone(), noise_seeds: 1 }
    }
}

/// What is known of the worlds of an atlas: those under all of whose conditions a trial ended.
///
/// # Errors
/// A world that is no indoor map, or has no difficulty vector.
pub fn samples(
    survey: &Survey,
    records: &[&Record],
    scale: &Scale,
) -> Result<Vec<Sample>, ExperimentError> {
    let mut measured: BTreeMap<u32, Vec<Dials<f64>>> = BTreeMap::new();
    for record in records {
        measured.entry(record.map).or_default().extend(record.scores.as_ref().map(scores));
    }
    let trials = survey.conditions.len() * survey.noise_seeds as usize;
    let whole: Vec<(SurveyMap<'_>, Dials<f64>)> = survey
        .maps()
        .filter_map(|map| {
            let scores = measured.get(&map.number).filter(|scores| scores.len() == trials)?;
            Some((map, scale.dials(mean(scores.iter().copied()))))
        })
        .collect();
    whole.into_par_iter().map(|(map, dials)| sample(&map, dials)).collect()
}

fn sample(map: &SurveyMap<'_>, dials: Dials<f64>) -> Result<Sample, ExperimentError> {
    let failed = |reason: String| {
        ExperimentError::Report(format!("world {} ({}): {reason}", map.number, map.family.name))
    };
    let WorldSpec::Indoor(spec) = &map.family.spec else {
        return Err(failed("this is no indoor map".to_owned()));
    };
    let plan = spec.generate(map.seed).map_err(|error| failed(error.to_string()))?;
    Sample::new(spec, &plan.to_world(), dials).map_err(|error| failed(error.to_string()))
}

/// The samples as a Parquet file, one world per row: what its settings say, the features of its difficulty
/// vector, and its measured dials.
///
/// # Errors
/// The file cannot be written.
pub fn table(samples: &[Sample]) -> Result<Vec<u8>, ExperimentError> {
    let column = |name: String, value: &dyn Fn(&Sample) -> Option<f64>| table::Column {
        name,
        values: table::Values::Real(samples.iter().map(value).collect()),
    };
    let mut columns = vec![
        column("difficulty".to_owned(), &|sample| Some(sample.dials.difficulty)),
        column("mapping".to_owned(), &|sample| Some(sample.dials.mapping)),
        column("navigation".to_owned(), &|sample| Some(sample.dials.navigation)),
    ];
    let terms = samples.first().map_or(&[][..], |sample| &sample.terms);
    for (i, (name, _)) in terms.iter().enumerate() {
        columns.push(column(format!("setting_{name}"), &|sample| Some(sample.terms[i].1)));
    }
    for (i, feature) in envgen::difficulty::DifficultyVector::features().iter().enumerate() {
        columns.push(column(feature.name.to_owned(), &|sample| sample.features[i]));
    }
    table::parquet(&columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_take_turns_and_all_worlds_are_there() {
        let design = AtlasDesign::first();
        let survey = design.survey(&Panel::reference());
        assert_eq!(survey.validate(), Ok(()));
        let all: u32 = design.sizes.iter().map(|size| size.maps).sum();
        assert_eq!(survey.families.len(), all as usize);
        for size in &design.sizes {
            let name = format!("{} x {},", size.width, size.height);
            let of = |families: &[Family]| {
                families.iter().filter(|family| family.name.starts_with(&name)).count() as f64
            };
            assert_eq!(of(&survey.families), f64::from(size.maps));
            let half = of(&survey.families[..survey.families.len() / 2]);
            assert!((half / f64::from(size.maps) - 0.5).abs() < 0.1, "{name} {half}");
        }
    }
}
