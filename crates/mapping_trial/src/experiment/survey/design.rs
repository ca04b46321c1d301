//! Surveys: the worlds, conditions and trials of which they consist.

use std::collections::{BTreeMap, BTreeSet};

use envgen::scenario::ScenarioSpec;
use envgen::settings::Setting;
use envgen::{Seed, SettingsError, SpecError, WorldSpec};
use ron::extensions::Extensions;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::driver::command;
use crate::lidar::LaserProfile;
use crate::odometry::OdometryProfile;
use crate::policy::PolicyKind;
use crate::robot::Robot;
use crate::slam::{SlamKind, WheelCalibration};
use crate::trial::TrialSettings;

/// Greatest number of trials of a survey.
pub const MAX_SURVEY_TRIALS: u64 = 1_000_000;

/// Greatest number of noise seeds per map and condition.
const MAX_NOISE_SEEDS: u32 = 1000;

/// Difference of the noise seeds of two worlds with the same seed. No two trials have the same noise
/// seed as long as fewer than 65,536 worlds have the same seed, and seeds are below this number divided
/// by [`MAX_NOISE_SEEDS`] times the number of conditions.
const BETWEEN_SAME_SEEDS: u64 = 1 << 48;

const NOISE_SEEDS: Setting =
    Setting::integer("noise_seeds", 1, MAX_NOISE_SEEDS as u64, "Trials per map and condition");

const MAPS: Setting = Setting::integer("maps", 1, MAX_SURVEY_TRIALS, "Worlds of a family");

/// A survey: trials under several conditions in families of worlds.
///
/// ```
/// use mapping_trial::experiment::survey::Survey;
///
/// let survey = Survey::from_ron(
///     "(
///         families: [
///             (name: \"rooms\", spec: Indoor(width: 8, height: 8), maps: 10),
///             (name: \"corridors\", spec: Hallway(segments: 30), maps: 5, first_seed: 100),
///         ],
///         conditions: [
///             (name: \"nearest\", time_per_area: 2),
///             (name: \"poor wheels\", odometry: \"poor\", slam: pose_graph),
///         ],
///         noise_seeds: 3,
///     )",
/// )?;
/// assert_eq!(survey.maps().count(), 15);
/// assert_eq!(survey.trials(), 15 * 2 * 3);
/// # Ok::<(), mapping_trial::experiment::survey::SurveyError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Survey {
    /// The worlds.
    pub families: Vec<Family>,
    /// The conditions, each of which is used in every world.
    pub conditions: Vec<Condition>,
    /// Number of trials per world and condition, which differ in sensor noise.
    #[serde(default = "one")]
    pub noise_seeds: u32,
    /// Which trials of a world have the same sensor noise.
    #[serde(default, skip_serializing_if = "SurveyNoise::is_default")]
    pub noise: SurveyNoise,
}

/// Which trials of a world have the same sensor noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurveyNoise {
    /// Trials under different conditions share noise, for paired differences of conditions.
    #[default]
    Shared,
    /// No two trials share noise, not even in different worlds. This is for means, in which shared
    /// noise would not average out.
    Own,
}

/// A family of worlds, which have the same spec and consecutive seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Family {
    /// Name of the family in tables.
    pub name: String,
    /// Spec of the worlds.
    pub spec: WorldSpec,
    /// Number of worlds.
    #[serde(default = "one")]
    pub maps: u32,
    /// Seed of the first world.
    #[serde(default)]
    pub first_seed: Seed,
}

/// A condition: what a trial depends on besides its world and noise. The defaults are those of
/// [`TrialSettings`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Condition {
    /// Name of the condition in tables.
    pub name: String,
    /// The policy that drives. Its name in files is `operator`.
    #[serde(rename = "operator", alias = "policy")]
    pub policy: PolicyKind,
    /// Command of a [driver](crate::driver) that drives in place of the policy. Each trial starts a
    /// process of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driver: Option<String>,
    /// The estimator of poses and map.
    pub slam: SlamKind,
    /// The systematic errors of the wheels that are learned.
    #[serde(skip_serializing_if = "WheelCalibration::is_default")]
    pub wheel_calibration: WheelCalibration,
    /// What the laser measures; in files the name of a built-in profile, or numbers.
    #[serde(with = "crate::profile")]
    pub laser: LaserProfile,
    /// What the wheels measure; in files the name of a built-in profile, or numbers.
    #[serde(with = "crate::profile")]
    pub odometry: OdometryProfile,
    /// The robot.
    pub robot: Robot,
    /// Time limit in seconds.
    pub time_limit: f64,
    /// Time limit in seconds per square metre that can be mapped, in place of `time_limit`.
    pub time_per_area: Option<f64>,
    /// The doors, people and smoke, drawn with the seed of the world.
    #[serde(skip_serializing_if = "ScenarioSpec::is_still")]
    pub scenario: ScenarioSpec,
}

impl Default for Condition {
    fn default() -> Self {
        let settings = TrialSettings::default();
        Condition {
            name: String::new(),
            policy: settings.policy.unwrap_or(PolicyKind::Nearest),
            driver: None,
            slam: settings.slam,
            wheel_calibration: settings.wheel_calibration,
            laser: settings.laser,
            odometry: settings.odometry,
            robot: settings.body,
            time_limit: settings.time_limit,
            time_per_area: settings.time_per_area,
            scenario: ScenarioSpec::default(),
        }
    }
}

/// An error in a survey or in its text.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SurveyError {
    /// A syntax error or an unknown field, with its line and column.
    #[error("not valid RON for this file, at {0}")]
    Ron(#[from] Box<ron::error::SpannedError>),
    /// A value that is not allowed.
    #[error("{place}: {error}")]
    Value {
        /// The family or condition, or `survey`.
        place: String,
        /// The field, its value and what is allowed.
        error: SpecError,
    },
    /// Settings that do not exist for a kind of world.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// A world of a survey, of [`Survey::maps`].
#[derive(Clone, Copy, Debug)]
pub struct SurveyMap<'a> {
    /// Number of the world in the survey, from 0.
    pub number: u32,
    /// Family of the world.
    pub family: &'a Family,
    /// Seed of the world.
    pub seed: Seed,
    /// Number of worlds of the same seed in earlier families. It is 0 where noise is shared, which does
    /// not depend on it. So a map is valid as long as its survey is unchanged.
    earlier: u64,
}

fn one() -> u32 {
    1
}

impl Condition {
    /// Returns the settings of its trials for a seed of sensor noise.
    ///
    /// # Errors
    ///
    /// If a number is not allowed, or if a driver names no program.
    pub fn settings(&self, noise: Seed) -> Result<TrialSettings, SpecError> {
        let settings = TrialSettings {
            seed: noise,
            policy: Some(self.policy),
            slam: self.slam,
            wheel_calibration: self.wheel_calibration,
            laser: self.laser.clone(),
            odometry: self.odometry.clone(),
            body: self.robot.clone(),
            time_limit: self.time_limit,
            time_per_area: self.time_per_area,
            ..TrialSettings::default()
        };
        settings.validate()?;
        self.scenario.validate().map_err(|error| error.within("scenario"))?;
        if let Some(line) = &self.driver {
            let not = |error| SpecError::new("driver", format!("`{line}`: {error}"), "a command");
            command(line).map_err(not)?;
        }
        Ok(settings)
    }
}

impl Survey {
    /// Reads a survey from RON, with specs of worlds as in `.envgen.ron` files, and checks it.
    ///
    /// # Errors
    ///
    /// Returns line and column of a syntax error, or names the first value that is not allowed.
    pub fn from_ron(text: &str) -> Result<Self, SurveyError> {
        let survey: Survey = ron_options().from_str(text).map_err(Box::new)?;
        survey.validate()?;
        Ok(survey)
    }

    /// Checks every value.
    ///
    /// # Errors
    ///
    /// Names the first value that is not allowed.
    pub fn validate(&self) -> Result<(), SurveyError> {
        let whole = || at("survey");
        NOISE_SEEDS.check_integer(u64::from(self.noise_seeds)).map_err(whole())?;
        names("families", self.families.iter().map(|family| &family.name)).map_err(whole())?;
        for family in &self.families {
            MAPS.check_integer(u64::from(family.maps)).map_err(at(&family.name))?;
            family.spec.validate().map_err(at(&family.name))?;
            let last = u64::from(family.maps) - 1;
            if family.first_seed.checked_offset(last).is_none() {
                let allowed = format!("at most {}", u64::MAX - last);
                let error = SpecError::new("first_seed", family.first_seed, allowed);
                return Err(at(&family.name)(error));
            }
        }
        check_conditions(&self.conditions)?;
        if self.trials() > MAX_SURVEY_TRIALS {
            let allowed = format!("at most {MAX_SURVEY_TRIALS} trials");
            return Err(whole()(SpecError::new("families", self.trials(), allowed)));
        }
        Ok(())
    }

    /// Returns the worlds of the survey.
    pub fn maps(&self) -> impl Iterator<Item = SurveyMap<'_>> {
        let all = self.families.iter().flat_map(|family| {
            (0..u64::from(family.maps)).map(move |n| (family, family.first_seed.offset(n)))
        });
        // Counted as the worlds are listed, since there may be as many families as worlds.
        let mut counts = (self.noise == SurveyNoise::Own).then(BTreeMap::<Seed, u64>::new);
        all.zip(0..).map(move |((family, seed), number)| {
            let earlier = counts.as_mut().map_or(0, |counts| {
                let count = counts.entry(seed).or_default();
                *count += 1;
                *count - 1
            });
            SurveyMap { number, family, seed, earlier }
        })
    }

    /// Returns the number of trials.
    pub fn trials(&self) -> u64 {
        let maps: u64 = self.families.iter().map(|family| u64::from(family.maps)).sum();
        let per_map = self.conditions.len() as u64 * u64::from(self.noise_seeds);
        maps.saturating_mul(per_map)
    }

    /// Returns the seed of the sensor noise of a trial, given its world, which must be one of this survey,
    /// and the numbers of its condition and of its noise seed.
    ///
    /// It depends on the seed of the world. If trials share no noise, it also depends on the number of
    /// conditions and on the number of earlier families with a world of this seed, but not on other
    /// families.
    pub fn noise_seed(&self, map: &SurveyMap<'_>, condition: u32, noise: u32) -> Seed {
        let (per_seed, own) = match self.noise {
            SurveyNoise::Shared => (1, 0),
            SurveyNoise::Own => {
                let own = map.earlier.wrapping_mul(BETWEEN_SAME_SEEDS);
                (self.conditions.len() as u64, own.wrapping_add(condition.into()))
            }
        };
        let first = map.seed.0.wrapping_mul(per_seed * u64::from(MAX_NOISE_SEEDS));
        Seed(first).offset(u64::from(noise) * per_seed).offset(own)
    }
}

impl SurveyNoise {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// The options for RON in surveys and panels, with specs as in `.envgen.ron` files.
pub(crate) fn ron_options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
        .with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Checks conditions, no two of which may have the same name.
///
/// # Errors
///
/// Names the first value that is not allowed.
pub(crate) fn check_conditions(conditions: &[Condition]) -> Result<(), SurveyError> {
    names("conditions", conditions.iter().map(|one| &one.name)).map_err(at("survey"))?;
    for condition in conditions {
        condition.settings(Seed(0)).map_err(at(&condition.name))?;
    }
    Ok(())
}

/// Returns an error of a value at a place.
fn at(place: &str) -> impl FnOnce(SpecError) -> SurveyError + use<> {
    let place = place.to_owned();
    move |error| SurveyError::Value { place, error }
}

/// Checks that a list is not empty, and that no name occurs twice.
fn names<'a>(
    field: &'static str,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), SpecError> {
    let names: Vec<&String> = names.collect();
    let distinct: BTreeSet<&String> = names.iter().copied().collect();
    if names.is_empty() || distinct.len() < names.len() {
        let text = names.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ");
        let text = if names.is_empty() { "none".to_owned() } else { text };
        return Err(SpecError::new(field, text, "one or more, each of another name"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn survey() -> Survey {
        let condition = |name: &str| Condition { name: name.to_owned(), ..Condition::default() };
        let family = |name: &str, maps, first_seed| Family {
            name: name.to_owned(),
            spec: envgen::indoor::IndoorSpec::default().into(),
            maps,
            first_seed: Seed(first_seed),
        };
        Survey {
            families: vec![family("a", 3, 0), family("b", 2, 40)],
            conditions: vec![condition("one"), condition("two")],
            noise_seeds: 2,
            noise: SurveyNoise::Shared,
        }
    }

    /// The noise seeds of all trials, by map, condition and number.
    fn noise_seeds(survey: &Survey) -> Vec<Seed> {
        let trials = survey.maps().flat_map(|map| {
            (0..2).flat_map(move |one| (0..2).map(move |n| survey.noise_seed(&map, one, n)))
        });
        trials.collect()
    }

    #[test]
    fn noise_is_shared_by_conditions_or_by_no_trials() {
        let mut survey = survey();
        let seeds = |all: &[u64]| all.iter().map(|seed| Seed(*seed)).collect::<Vec<Seed>>();
        let shared = noise_seeds(&survey);
        assert_eq!(shared[4..8], seeds(&[1000, 1001, 1000, 1001]));
        assert_eq!(shared[16..], seeds(&[41_000, 41_001, 41_000, 41_001]));
        survey.noise = SurveyNoise::Own;
        let mut own = noise_seeds(&survey);
        assert_eq!(own[4..8], seeds(&[2000, 2002, 2001, 2003]));
        own.sort_unstable();
        own.dedup();
        assert_eq!(own.len(), 20);
    }

    #[test]
    fn worlds_of_one_seed_have_noise_of_their_own() {
        let mut survey = Survey { noise: SurveyNoise::Own, ..survey() };
        let first = noise_seeds(&survey);
        // The second family begins with the seed of the first one's last world.
        survey.families[1].first_seed = Seed(2);
        let mut all = noise_seeds(&survey);
        assert_eq!(all[..12], first[..12]);
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 20);
    }

    /// The offset of a world's noise by going through all families before its own.
    fn earlier_by_families(survey: &Survey, map: &SurveyMap<'_>) -> u64 {
        let earlier = survey.families.iter().take_while(|one| one.name != map.family.name);
        let has_seed = |family: &&Family| {
            let number = map.seed.0.checked_sub(family.first_seed.0);
            number.is_some_and(|number| number < u64::from(family.maps))
        };
        earlier.filter(has_seed).count() as u64
    }

    proptest! {
        #[test]
        fn worlds_of_a_seed_are_counted_over_earlier_families(
            families in prop::collection::vec((1..9_u32, 0..12_u64), 1..9),
            last: bool, condition in 0..2_u32, noise in 0..2_u32,
        ) {
            let mut survey = Survey { noise: SurveyNoise::Own, ..survey() };
            let of = |(i, (maps, first)): (usize, (u32, u64))| Family {
                name: i.to_string(),
                maps,
                first_seed: Seed(if last { u64::MAX - 20 + first } else { first }),
                ..survey.families[0].clone()
            };
            survey.families = families.into_iter().enumerate().map(of).collect();
            prop_assert_eq!(survey.validate(), Ok(()));
            for map in survey.maps() {
                let earlier = earlier_by_families(&survey, &map);
                prop_assert_eq!(map.earlier, earlier);
                let first = Seed(map.seed.0.wrapping_mul(2000)).offset(u64::from(noise) * 2);
                let expected = first.offset((earlier << 48) + u64::from(condition));
                prop_assert_eq!(survey.noise_seed(&map, condition, noise), expected);
            }
        }
    }

    /// It would take minutes if each family went through all others.
    #[test]
    fn there_may_be_very_many_families() {
        let mut survey = Survey { noise: SurveyNoise::Own, noise_seeds: 1, ..survey() };
        let family = |i: u64| Family {
            name: format!("family {i}"),
            spec: envgen::hallway::HallwaySpec::default().into(),
            maps: 1,
            first_seed: Seed(i / 2),
        };
        survey.families = (0..200_000).map(family).collect();
        assert_eq!(survey.validate(), Ok(()));
        let mut seeds: Vec<Seed> = survey.maps().map(|map| survey.noise_seed(&map, 1, 0)).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 200_000);
        survey.families[199_999].name = "family 7".to_owned();
        let error = survey.validate().expect_err("a name twice").to_string();
        assert!(error.contains("each of another name"), "{}", &error[..99]);
    }

    #[test]
    fn maps_are_numbered_over_all_families() {
        let survey = survey();
        assert_eq!(survey.validate(), Ok(()));
        let maps: Vec<_> =
            survey.maps().map(|map| (map.number, map.family.name.as_str(), map.seed.0)).collect();
        assert_eq!(maps, [(0, "a", 0), (1, "a", 1), (2, "a", 2), (3, "b", 40), (4, "b", 41)]);
        assert_eq!(survey.trials(), 20);
    }

    #[test]
    fn the_written_form_is_read_again() {
        let survey = Survey { noise: SurveyNoise::Own, ..survey() };
        let text = ron::to_string(&survey).expect("RON");
        // Without extensions newtype variants have a second pair of parentheses.
        assert_eq!(ron::from_str::<Survey>(&text), Ok(survey));
    }

    #[test]
    fn every_bad_value_is_named_with_its_place() {
        let error = |change: &dyn Fn(&mut Survey)| {
            let mut survey = survey();
            change(&mut survey);
            survey.validate().expect_err("not allowed").to_string()
        };
        let text = error(&|s| s.noise_seeds = 0);
        assert_eq!(text, "survey: `noise_seeds` must be a whole number from 1 to 1000, got 0");
        assert!(error(&|s| s.conditions.clear()).contains("`conditions` must be one or more"));
        assert!(error(&|s| s.families[1].name = "a".into()).contains("each of another name"));
        assert!(error(&|s| s.families[1].maps = 0).starts_with("b: `maps` must be"));
        assert!(error(&|s| s.families[0].first_seed = Seed(u64::MAX)).contains("a: `first_seed`"));
        let text = error(&|s| s.conditions[1].laser.beams = 0);
        assert!(text.starts_with("two: `laser.beams` must be a whole number"), "{text}");
        assert!(error(&|s| s.conditions[0].time_per_area = Some(f64::NAN)).contains("NaN"));
        let text = error(&|s| s.families[0].maps = 1_000_000);
        assert!(text.contains("at most 1000000 trials"), "{text}");
        let text = Survey::from_ron("# A survey").expect_err("no RON").to_string();
        assert!(text.starts_with("not valid RON for this file, at 1:2"), "{text}");
        let text = Survey::from_ron("(familes: [])").expect_err("unknown").to_string();
        assert!(text.contains("familes"), "{text}");
    }
}
