//! Atlases: sets of measured worlds to which predictions are fitted.

use std::collections::BTreeMap;

use envgen::calibration::{Dials, Scale};
use envgen::indoor::IndoorSpec;
use envgen::settings::Allowed;
use envgen::{Seed, SettingsError, Spec, SpecError, WorldKind, WorldSpec};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::fit::Sample;
use super::measure::{mean, scores};
use super::panel::Panel;
use crate::experiment::survey::{
    Family, MAX_SURVEY_TRIALS, Record, Survey, SurveyError, SurveyMap, SurveyNoise, ron_options,
};
use crate::experiment::{ExperimentError, table};

const INDOOR: &str = include_str!("atlas/indoor.ron");
const INDOOR_SMALL: &str = include_str!("atlas/indoor_small.ron");
const HALLWAY: &str = include_str!("atlas/hallway.ron");
const FOREST: &str = include_str!("atlas/forest.ron");

/// The design of an atlas: which worlds it has.
///
/// ```
/// use envgen::WorldKind;
/// use mapping_trial::difficulty::{AtlasDesign, Panel};
///
/// let design = AtlasDesign::of(WorldKind::Forest).expect("forests are calibrated");
/// assert_eq!(design.kind(), WorldKind::Forest);
/// // Every world under every condition once.
/// let panel = Panel::reference();
/// let survey = design.survey(&panel)?;
/// assert_eq!(survey.trials(), (survey.maps().count() * panel.conditions.len()) as u64);
/// assert_eq!(AtlasDesign::of(WorldKind::Road), None);
/// # Ok::<(), envgen::SettingsError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum AtlasDesign {
    /// Indoor maps of several sizes, whose levers are drawn.
    Indoor {
        /// The sizes.
        sizes: Vec<AtlasSize>,
        /// Seed of the first world.
        first_seed: Seed,
    },
    /// Worlds of which some settings are drawn.
    Drawn {
        /// The spec with all other settings.
        spec: Box<WorldSpec>,
        /// Least and greatest value of each drawn setting. All values between them have the same
        /// probability; the two ends of integers have half of it.
        drawn: BTreeMap<String, [f64; 2]>,
        /// Number of worlds.
        maps: u32,
        /// Seed of the first world.
        first_seed: Seed,
    },
}

/// Worlds of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtlasSize {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Number of worlds.
    pub maps: u32,
}

impl AtlasDesign {
    /// Returns the design of the atlas to which a calibration of `envgen` was fitted; `None` for kinds
    /// that have none. For indoor maps that are smaller than this atlas has,
    /// [`indoor_small`](Self::indoor_small) has another.
    ///
    /// # Panics
    ///
    /// Never: the files are part of the crate, and tested.
    pub fn of(kind: WorldKind) -> Option<Self> {
        let text = match kind {
            WorldKind::Indoor => INDOOR,
            WorldKind::Hallway => HALLWAY,
            WorldKind::Forest => FOREST,
            _ => return None,
        };
        Some(Self::from_ron(text).expect("a design of an atlas"))
    }

    /// Returns the design of the atlas of small indoor maps.
    ///
    /// # Panics
    ///
    /// Never: the file is part of the crate, and tested.
    pub fn indoor_small() -> Self {
        Self::from_ron(INDOOR_SMALL).expect("a design of an atlas")
    }

    /// Reads a design from RON.
    ///
    /// # Errors
    ///
    /// Returns line and column of a syntax error.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        Ok(ron_options().from_str(text).map_err(Box::new)?)
    }

    /// Returns the version of the calibration that is fitted to this atlas. It rises when inputs, coefficients or
    /// atlases change. The calibration of small indoor maps has a version of its own.
    pub fn version(&self) -> u32 {
        if *self == Self::indoor_small() { 3 } else { 2 }
    }

    /// Returns the kind of its worlds.
    pub fn kind(&self) -> WorldKind {
        match self {
            AtlasDesign::Indoor { .. } => WorldKind::Indoor,
            AtlasDesign::Drawn { spec, .. } => spec.kind(),
        }
    }

    /// Returns the survey of the atlas, which has every world under every condition once.
    ///
    /// # Errors
    ///
    /// If a setting does not exist or is not a number, if its range is not allowed, if maps cannot have
    /// a size, or if there would be more worlds than a survey may have trials.
    pub fn survey(&self, panel: &Panel) -> Result<Survey, SettingsError> {
        self.check()?;
        let families = match self {
            AtlasDesign::Indoor { sizes, first_seed } => indoor(sizes, *first_seed),
            AtlasDesign::Drawn { spec, drawn, maps, first_seed } => {
                let seeds = (0..*maps).map(|i| first_seed.offset(u64::from(i)));
                seeds.map(|seed| family(spec, drawn, seed)).collect::<Result<_, _>>()?
            }
        };
        let conditions = panel.conditions.clone();
        Ok(Survey { families, conditions, noise_seeds: 1, noise: SurveyNoise::Own })
    }
}

impl AtlasDesign {
    /// Checks what is not checked for each world.
    fn check(&self) -> Result<(), SpecError> {
        let maps: u64 = match self {
            AtlasDesign::Indoor { sizes, .. } => {
                for &AtlasSize { width, height, .. } in sizes {
                    IndoorSpec { width, height, ..Default::default() }.validate()?;
                }
                sizes.iter().map(|size| u64::from(size.maps)).sum()
            }
            AtlasDesign::Drawn { drawn, maps, .. } => {
                for (name, &[least, most]) in drawn {
                    let is_range = least <= most && (most - least).is_finite();
                    if !is_range {
                        let allowed = "two finite numbers, the smaller one first";
                        return Err(SpecError::new(name, format!("({least}, {most})"), allowed));
                    }
                }
                u64::from(*maps)
            }
        };
        if maps > MAX_SURVEY_TRIALS {
            return Err(SpecError::new("maps", maps, format!("at most {MAX_SURVEY_TRIALS}")));
        }
        Ok(())
    }
}

/// Creates indoor maps in which sizes take turns, so that a part of the survey has worlds of all sizes.
fn indoor(sizes: &[AtlasSize], first_seed: Seed) -> Vec<Family> {
    let most = sizes.iter().map(|size| size.maps).max().unwrap_or(0);
    let mut families = Vec::new();
    for round in 0..most {
        for size in sizes {
            // Evenly spread over the rounds.
            let share = |rounds: u32| u64::from(size.maps) * u64::from(rounds) / u64::from(most);
            let (before, after) = (share(round), share(round + 1));
            if after == before {
                continue;
            }
            let seed = first_seed.offset(families.len() as u64);
            let base = IndoorSpec { width: size.width, height: size.height, ..Default::default() };
            families.push(Family {
                name: format!("{} x {}, {seed}", size.width, size.height),
                spec: WorldSpec::from(base.draw_levers(seed)),
                maps: 1,
                first_seed: seed,
            });
        }
    }
    families
}

/// A world whose settings are drawn.
fn family(
    spec: &WorldSpec,
    drawn: &BTreeMap<String, [f64; 2]>,
    seed: Seed,
) -> Result<Family, SettingsError> {
    let mut spec = spec.clone();
    for (name, &[least, most]) in drawn {
        let value = seed.stream(&format!("atlas/{name}"), 0).between(least, most);
        let is_whole = matches!(spec.kind().setting(name)?.allowed, Allowed::Integer { .. });
        let digits = if is_whole { 0 } else { 4 };
        spec.set(name, &format!("{value:.digits$}"))?;
    }
    Ok(Family { name: format!("{} {seed}", spec.kind().name()), spec, maps: 1, first_seed: seed })
}

/// Returns the samples of an atlas: its worlds of which all trials have scores.
///
/// # Errors
///
/// If a world cannot be generated, or if it has no difficulty vector.
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
    let failed = |reason: String| ExperimentError::World {
        world: format!("world {} ({})", map.number, map.family.name),
        reason,
    };
    let spec = &map.family.spec;
    let blueprint = spec.generate(map.seed).map_err(|error| failed(error.to_string()))?;
    Sample::new(spec, &blueprint.to_world(), dials).map_err(|error| failed(error.to_string()))
}

/// Returns the samples as a Parquet file, with one world per row: terms of its settings, the features
/// of its difficulty vector, and its measured dials.
///
/// # Errors
///
/// If the file cannot be written.
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
        let design = AtlasDesign::of(WorldKind::Indoor).expect("an atlas");
        let survey = design.survey(&Panel::reference()).expect("a survey");
        let AtlasDesign::Indoor { sizes, .. } = &design else { panic!("{design:?}") };
        let all: u32 = sizes.iter().map(|size| size.maps).sum();
        assert_eq!(survey.families.len(), all as usize);
        for size in sizes {
            let name = format!("{} x {},", size.width, size.height);
            let of = |families: &[Family]| {
                families.iter().filter(|family| family.name.starts_with(&name)).count() as f64
            };
            assert_eq!(of(&survey.families), f64::from(size.maps));
            let half = of(&survey.families[..survey.families.len() / 2]);
            assert!((half / f64::from(size.maps) - 0.5).abs() < 0.1, "{name} {half}");
        }
    }

    #[test]
    fn every_world_of_every_atlas_can_be_generated() {
        let kinds = [WorldKind::Indoor, WorldKind::Hallway, WorldKind::Forest];
        let of_kinds = kinds.map(|kind| (kind, AtlasDesign::of(kind).expect("an atlas")));
        let small = (WorldKind::Indoor, AtlasDesign::indoor_small());
        for (kind, design) in of_kinds.into_iter().chain([small]) {
            assert_eq!(design.kind(), kind);
            let survey = design.survey(&Panel::reference()).expect("a survey");
            assert_eq!(survey.validate(), Ok(()));
            for map in survey.maps().step_by(9) {
                let world = map.family.spec.generate(map.seed).expect("a blueprint").to_world();
                assert_eq!(world.check(), Ok(()));
                assert!(world.start.is_some(), "{}", map.family.name);
            }
        }
        assert_eq!(AtlasDesign::of(WorldKind::Road), None);
    }

    #[test]
    fn settings_are_drawn_within_their_ranges() {
        let design = |drawn: &str| {
            let text = format!("Drawn(spec: Hallway(), drawn: {drawn}, maps: 20, first_seed: 1)");
            AtlasDesign::from_ron(&text).expect("a design").survey(&Panel::reference())
        };
        let survey = design("{\"segments\": (5, 9), \"p_st\": (0.2, 0.3)}").expect("a survey");
        let mut seen = std::collections::BTreeSet::new();
        for family in &survey.families {
            let WorldSpec::Hallway(spec) = &family.spec else { panic!("{family:?}") };
            assert!((5..=9).contains(&spec.segments) && (0.2..=0.3).contains(&spec.p_st));
            seen.insert(spec.segments);
        }
        assert_eq!(seen.len(), 5);
        let error = |drawn: &str| design(drawn).expect_err("no survey").to_string();
        assert!(error("{\"segment\": (5, 9)}").contains("segment"));
        assert!(error("{\"p_st\": (2, 3)}").starts_with("`p_st` must be"));
        for range in ["(0.3, 0.2)", "(NaN, 1)", "(-inf, 1)", "(-1e308, 1.7e308)"] {
            let error = error(&format!("{{\"p_st\": {range}}}"));
            assert!(error.starts_with("`p_st` must be two finite numbers"), "{error}");
        }
    }

    #[test]
    fn atlases_that_cannot_be_generated_are_refused() {
        let error = |text: &str| {
            let design = AtlasDesign::from_ron(text).expect("a design");
            design.survey(&Panel::reference()).expect_err("no survey").to_string()
        };
        let sizes = |width: u32, maps: u32| {
            format!("Indoor(sizes: [(width: {width}, height: 9, maps: {maps})], first_seed: 1)")
        };
        assert!(error(&sizes(0, 1)).starts_with("`width` must be"));
        assert!(error(&sizes(9, u32::MAX)).starts_with("`maps` must be at most 1000000"));
        let drawn = "Drawn(spec: Hallway(), drawn: {}, maps: 4294967295, first_seed: 1)";
        assert!(error(drawn).starts_with("`maps` must be at most 1000000"));
        // Products of 32 bits would overflow.
        let text = sizes(9, 70_000);
        let design = AtlasDesign::from_ron(&text).expect("a design");
        assert_eq!(design.survey(&Panel::reference()).expect("a survey").families.len(), 70_000);
    }
}
