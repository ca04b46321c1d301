//! The cost of doors, people and smoke, from the same trials with and without them.
//!
//! Every world is mapped under every condition without anything that moves, and with each hazard alone,
//! all with the same sensor noise. The cost of a hazard is the mean paired difference of a score.

use std::collections::BTreeMap;

use envgen::assignment::{Assignment, assignments};
use envgen::located::Located;
use envgen::scenario::ScenarioSpec;
use envgen::{Seed, SpecError};
use serde::Serialize;

use super::design::{Design, policy_name};
use super::stats::{Interval, mean_and_half};
use super::survey::{Condition, Family, Record, Survey, SurveyNoise};
use crate::score::Scores;

/// A hazard: something that moves in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Hazard {
    /// Name of the hazard in tables: its settings with their values, joined by `+`.
    pub name: String,
    /// What moves.
    pub scenario: ScenarioSpec,
}

/// The hazards with a default amount, by the name of their setting.
const USUAL: [(&str, &str); 3] = [("doors", "0.5"), ("people", "8"), ("smoke", "0.3")];

/// The cost of a hazard.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HazardCost {
    /// Name of the hazard.
    pub hazard: String,
    /// Number of worlds.
    pub maps: usize,
    /// Mean difference of D from the same trials without the hazard, with Student's 95 % interval over
    /// worlds.
    pub difficulty: Interval,
    /// Mean difference of M, likewise.
    pub mapping: Interval,
    /// Mean difference of N, likewise.
    pub navigation: Interval,
    /// Mean number of collisions with people per trial. Its name in files is `person_hits`.
    #[serde(rename = "person_hits")]
    pub person_collisions: f64,
    /// Mean area of ghosts on a map, in square metres.
    pub ghost_area: f64,
}

impl Hazard {
    /// Parses a hazard: a name such as `doors`, a setting of scenarios with its value, such as
    /// `doors=1` or `people=20`, or several of these joined by `+`.
    ///
    /// ```
    /// use mapping_trial::experiment::hazards::Hazard;
    ///
    /// let hazard = Hazard::parse("people=20")?;
    /// assert_eq!((hazard.name.as_str(), hazard.scenario.people), ("people=20", 20));
    /// let both = Hazard::parse("doors=1+people=20")?.scenario;
    /// assert_eq!((both.doors, both.people), (1.0, 20));
    /// assert!(Hazard::parse("lions=3").is_err());
    /// assert!(Hazard::parse("slam=1").is_err(), "nothing moves");
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a setting does not exist or occurs twice, if its value is not allowed, or if nothing moves.
    pub fn parse(text: &str) -> Result<Self, SpecError> {
        let mut scenario = ScenarioSpec::default();
        let setting = |part: &str| {
            let usual = USUAL.into_iter().find(|(name, _)| *name == part);
            if let Some((name, value)) = usual {
                return Ok(format!("{name}={value}"));
            }
            if part.contains('=') {
                return Ok(part.to_owned());
            }
            let names = USUAL.map(|(name, _)| name).join(", ");
            let allowed = format!(
                "one of {names}, a setting of scenarios and its value, as doors=1, or several \
                 joined by +"
            );
            Err(SpecError::new("hazards", part, allowed))
        };
        let texts = text.split('+').map(setting).collect::<Result<Vec<_>, _>>()?;
        let settings = assignments("hazards", &texts, ScenarioSpec::SETTINGS);
        let settings = settings.map_err(|Located { error, .. }| {
            let allowed = format!("settings of which each is there once: {error}");
            SpecError::new("hazards", text, allowed)
        })?;
        for Assignment { name, value, .. } in &settings {
            scenario.set(name, value)?;
        }
        if scenario.is_still() {
            let allowed =
                "something that moves: nothing does without doors, people or smoke above 0";
            return Err(SpecError::new("hazards", text, allowed));
        }
        let parts: Vec<_> = settings
            .iter()
            .map(|Assignment { name, value, .. }| format!("{name}={value}"))
            .collect();
        Ok(Hazard { name: parts.join("+"), scenario })
    }
}

/// Returns the survey of a design's levels and policies, without hazards and with each of them.
///
/// The worlds are as many as those of the design and have the same specs, but other seeds: those of the
/// first level begin with 1000, those of the next one with 2000, plus a million times the design's
/// seed. [`Design::world_seed`] is the same only for levels such as 0.1.
///
/// # Errors
///
/// If the design is not allowed, or if a hazard is given twice.
pub fn survey(design: &Design, hazards: &[Hazard]) -> Result<Survey, SpecError> {
    design.validate()?;
    for (i, hazard) in hazards.iter().enumerate() {
        if hazards[..i].iter().any(|other| other.scenario == hazard.scenario) {
            return Err(SpecError::new("hazards", &hazard.name, "each hazard once"));
        }
    }
    let mut conditions = Vec::new();
    for (name, scenario) in std::iter::once(("nothing moves", ScenarioSpec::default()))
        .chain(hazards.iter().map(|hazard| (hazard.name.as_str(), hazard.scenario.clone())))
    {
        for &policy in &design.policies {
            conditions.push(Condition {
                name: format!("{name}, {}", policy_name(policy)),
                policy,
                slam: design.slam,
                wheel_calibration: design.wheel_calibration,
                laser: design.laser.clone(),
                odometry: design.odometry.clone(),
                time_limit: design.time_limit,
                time_per_area: design.time_per_area,
                scenario: scenario.clone(),
                ..Condition::default()
            });
        }
    }
    let families = design.levels.iter().enumerate().map(|(i, &level)| Family {
        name: format!("level {level}"),
        spec: design.spec(level).into(),
        maps: design.maps,
        // Other seeds for each seed of a design, as in its experiment, but not the same seeds.
        first_seed: Seed(design.seed.0.wrapping_mul(1_000_000)).offset(1000 * (i as u64 + 1)),
    });
    let (families, noise_seeds) = (families.collect(), design.noise_seeds);
    Ok(Survey { families, conditions, noise_seeds, noise: SurveyNoise::Shared })
}

/// Checks that a survey, such as that of merged shares, belongs to these hazards.
///
/// # Errors
///
/// If the hazards or their order differ.
pub fn check(survey: &Survey, hazards: &[Hazard]) -> Result<(), SpecError> {
    let policies = survey.conditions.len() / (hazards.len() + 1);
    let still = std::iter::once(ScenarioSpec::default());
    let expected = still.chain(hazards.iter().map(|hazard| hazard.scenario.clone()));
    let mut groups = survey.conditions.chunks(policies.max(1)).zip(expected);
    let is_same = survey.conditions.len() == policies * (hazards.len() + 1)
        && groups.all(|(group, scenario)| group.iter().all(|one| one.scenario == scenario));
    if is_same {
        return Ok(());
    }
    // Conditions are named after the hazard and the policy.
    let mut names: Vec<&str> = Vec::new();
    for condition in survey.conditions.iter().filter(|condition| !condition.scenario.is_still()) {
        let name = condition.name.rsplit_once(", ").map_or("", |(hazard, _)| hazard);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let given: Vec<_> = hazards.iter().map(|hazard| hazard.name.as_str()).collect();
    let allowed = format!("those of the shares, {}", names.join(","));
    Err(SpecError::new("hazards", given.join(","), allowed))
}

/// Returns the cost of each hazard, given the records of the [`survey()`]. It leaves out hazards for
/// which no world has the trials both with and without them.
pub fn costs<'a>(
    survey: &Survey,
    hazards: &[Hazard],
    records: impl IntoIterator<Item = &'a Record>,
) -> Vec<HazardCost> {
    let policies = survey.conditions.len() / (hazards.len() + 1);
    let mut scores: BTreeMap<(u32, u32, u32), &Scores> = BTreeMap::new();
    for record in records {
        if let Some(found) = &record.scores {
            scores.insert((record.map, record.condition, record.noise), found);
        }
    }
    hazards
        .iter()
        .enumerate()
        .filter_map(|(number, hazard)| {
            let shift = ((number + 1) * policies) as u32;
            // The pairs of trials of each world.
            let mut worlds: BTreeMap<u32, Vec<(&Scores, &Scores)>> = BTreeMap::new();
            for (&(map, condition, noise), &without) in &scores {
                if (condition as usize) < policies
                    && let Some(&with) = scores.get(&(map, condition + shift, noise))
                {
                    worlds.entry(map).or_default().push((without, with));
                }
            }
            cost(hazard, &worlds.into_values().collect::<Vec<_>>())
        })
        .collect()
}

/// The cost over worlds, each with its pairs of trials without and with the hazard; `None` without any
/// pair.
fn cost(hazard: &Hazard, worlds: &[Vec<(&Scores, &Scores)>]) -> Option<HazardCost> {
    if worlds.is_empty() {
        return None;
    }
    let mean = |pairs: &Vec<(&Scores, &Scores)>, of: fn(&Scores) -> f64| {
        let sum: f64 = pairs.iter().map(|(without, with)| of(with) - of(without)).sum();
        sum / pairs.len() as f64
    };
    let parts: [fn(&Scores) -> f64; 3] =
        [|scores| scores.difficulty, |scores| scores.mapping, |scores| scores.navigation];
    let [difficulty, mapping, navigation] = parts.map(|part| {
        let differences: Vec<f64> = worlds.iter().map(|pairs| mean(pairs, part)).collect();
        let (value, half) = mean_and_half(&differences);
        Interval { value, low: value - half, high: value + half }
    });
    let with: Vec<&Scores> = worlds.iter().flatten().map(|(_, with)| *with).collect();
    let moving = |of: fn(crate::score::MovingScores) -> f64| {
        with.iter().filter_map(|scores| scores.moving).map(of).sum::<f64>() / with.len() as f64
    };
    Some(HazardCost {
        hazard: hazard.name.clone(),
        maps: worlds.len(),
        difficulty,
        mapping,
        navigation,
        person_collisions: moving(|moving| f64::from(moving.person_collisions)),
        ghost_area: moving(|moving| moving.ghost_area),
    })
}

#[cfg(test)]
mod tests {
    use envgen::WorldSpec;
    use envgen::scenario::FailedBeams;

    use super::*;
    use crate::lidar::LaserProfile;
    use crate::odometry::OdometryProfile;
    use crate::score::MovingScores;
    use crate::slam::{SlamKind, WheelCalibration};

    fn design() -> Design {
        Design { levels: vec![1.0, 5.0], maps: 2, size: 6, noise_seeds: 2, ..Design::quick() }
    }

    #[test]
    fn hazards_have_names_and_values() {
        let doors = Hazard::parse("doors").expect("a hazard");
        assert_eq!((doors.name.as_str(), doors.scenario.doors), ("doors=0.5", 0.5));
        assert_eq!(Hazard::parse("people=20").expect("a hazard").scenario.people, 20);
        let error = |text: &str| Hazard::parse(text).expect_err("no hazard").to_string();
        assert!(error("fire").starts_with("`hazards` must be one of doors, people, smoke"));
        assert!(error("smoke=-1").starts_with("`smoke` must be a number from 0"));
        assert!(error("fire=1").starts_with("`setting` must be one of doors"));
    }

    #[test]
    fn hazards_join_settings() {
        let hazard = Hazard::parse("smoke=0.3+failed_beams=phantom").expect("a hazard");
        assert_eq!(hazard.name, "smoke=0.3+failed_beams=phantom");
        assert_eq!(
            (hazard.scenario.smoke, hazard.scenario.failed_beams),
            (0.3, FailedBeams::Phantom)
        );
        let hazard = Hazard::parse("doors+people=8+smoke=0.3").expect("a hazard");
        assert_eq!(hazard.name, "doors=0.5+people=8+smoke=0.3");
        let scenario = hazard.scenario;
        assert_eq!((scenario.doors, scenario.people, scenario.smoke), (0.5, 8, 0.3));
        let error = |text: &str| Hazard::parse(text).expect_err("no hazard").to_string();
        for text in ["doors+", "+doors", "doors++people"] {
            assert!(error(text).starts_with("`hazards` must be one of doors, people, smoke"));
        }
        let twice = error("doors=1+doors");
        assert!(twice.ends_with("got doors=1+doors: `doors` is set twice"), "{twice}");
        assert!(error("doors+people=-1").starts_with("`people` must be a whole number from 0"));
    }

    #[test]
    fn hazards_that_move_nothing_are_refused() {
        for text in ["failed_beams=phantom", "body=legs", "slam=1", "people=0", "doors=0+smoke=0"] {
            let error = Hazard::parse(text).expect_err("nothing moves").to_string();
            assert_eq!(
                error,
                format!(
                    "`hazards` must be something that moves, got {text}: \
                     nothing does without doors, people or smoke above 0"
                )
            );
        }
    }

    #[test]
    fn conditions_are_those_of_the_design() {
        let design = Design {
            slam: SlamKind::DeadReckoning,
            wheel_calibration: WheelCalibration::None,
            laser: LaserProfile::URG_04LX,
            odometry: OdometryProfile::EXACT,
            time_limit: 77.0,
            time_per_area: Some(1.5),
            ..design()
        };
        let hazards = [Hazard::parse("doors").expect("a hazard")];
        for condition in survey(&design, &hazards).expect("a survey").conditions {
            let settings = condition.settings(Seed(0)).expect("settings");
            assert_eq!(settings.slam, design.slam);
            assert_eq!(settings.wheel_calibration, design.wheel_calibration);
            assert_eq!((&settings.laser, &settings.odometry), (&design.laser, &design.odometry));
            assert_eq!(settings.time_limit, design.time_limit);
            assert_eq!(settings.time_per_area, design.time_per_area);
        }
    }

    #[test]
    fn worlds_have_seeds_of_their_own() {
        let one = Design { seed: Seed(3), ..design() };
        for (design, offset) in [(design(), 0), (one, 3_000_000)] {
            let survey = survey(&design, &[]).expect("a survey");
            let seeds: Vec<u64> = survey.maps().map(|map| map.seed.0 - offset).collect();
            assert_eq!(seeds, [1000, 1001, 2000, 2001]);
            let specs = design.levels.iter().flat_map(|&level| [level, level]);
            let specs: Vec<WorldSpec> = specs.map(|level| design.spec(level).into()).collect();
            assert!(survey.maps().map(|map| &map.family.spec).eq(&specs));
            let trials = design.trials();
            let of_design = trials.iter().map(|trial| design.world_seed(trial).0 - offset);
            assert!(of_design.min().is_some_and(|least| least == 10_000));
        }
    }

    #[test]
    fn noise_is_the_same_with_and_without() {
        let hazards = [Hazard::parse("doors").expect("a hazard")];
        let survey = survey(&design(), &hazards).expect("a survey");
        assert_eq!(survey.validate(), Ok(()));
        assert_eq!(survey.conditions.len(), 2 * design().policies.len());
        assert!(survey.conditions[0].scenario.is_still());
        let text = serde_json::to_string(&survey.conditions[0]).expect("JSON");
        assert!(!text.contains("scenario"), "{text}");
    }

    #[test]
    fn hazards_are_given_once() {
        let hazards = ["people", "doors", "people=08"].map(|text| Hazard::parse(text).expect(text));
        let error = survey(&design(), &hazards).expect_err("a hazard twice").to_string();
        assert_eq!(error, "`hazards` must be each hazard once, got people=08");
    }

    #[test]
    fn the_hazards_of_a_survey_are_known_again() {
        let parse = |text: &str| Hazard::parse(text).expect("a hazard");
        let two = [parse("doors"), parse("smoke=0.3+people=8")];
        let survey = survey(&design(), &two).expect("a survey");
        assert_eq!(check(&survey, &two), Ok(()));
        let turned = [two[1].clone(), two[0].clone()];
        for other in [&two[..1], &turned[..], &[parse("doors=1"), two[1].clone()], &[]] {
            let error = check(&survey, other).expect_err("others").to_string();
            let expected =
                "`hazards` must be those of the shares, doors=0.5,smoke=0.3+people=8, got";
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn costs_are_paired_differences() {
        let hazards =
            [Hazard::parse("doors").expect("a hazard"), Hazard::parse("smoke").expect("one")];
        let survey = survey(&design(), &hazards).expect("a survey");
        let record = |map: u32, condition: u32, noise: u32, difficulty: f64| {
            let scores = Scores {
                difficulty,
                mapping: 2.0 * difficulty,
                moving: Some(MovingScores { person_collisions: 1, ..Default::default() }),
                ..Default::default()
            };
            Record { map, condition, noise, scores: Some(scores), ..Record::default() }
        };
        let mut records = Vec::new();
        for (map, base) in [(0, 1.0), (1, 4.0), (2, 2.0)] {
            for noise in 0..2 {
                let level = base + f64::from(noise);
                records.push(record(map, 0, noise, level));
                records.push(record(map, 1, noise, level + 0.5));
            }
        }
        let costs = costs(&survey, &hazards, &records);
        // No trial with smoke.
        assert_eq!(costs.len(), 1);
        assert_eq!((costs[0].hazard.as_str(), costs[0].maps), ("doors=0.5", 3));
        let half = Interval { value: 0.5, low: 0.5, high: 0.5 };
        let near =
            |a: Interval, b: f64| [a.value, a.low, a.high].iter().all(|x| (x - b).abs() < 1e-9);
        assert!(near(costs[0].difficulty, half.value) && near(costs[0].mapping, 1.0));
        assert!(near(costs[0].navigation, 0.0) && costs[0].person_collisions == 1.0);
    }
}
