//! Measures the difficulty of a world by trials of a panel in it.

use envgen::calibration::{Dials, Estimate, Scale};
use envgen::{MeasuredDifficulty, Seed, World};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::panel::Panel;
use super::placed::placed;
use super::usual_noise::usual_variance_under;
use crate::experiment::stats::half_interval;
use crate::experiment::survey::{Condition, Failure, Site};
use crate::robot::Robot;
use crate::score::Scores;
use crate::trial::{EndReason, LogWorld};

/// Weight of the usual variance, in degrees of freedom.
const USUAL_WEIGHT: f64 = 6.0;

/// An error for which the difficulty of a world cannot be measured.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// The panel has no conditions, over which difficulties are means.
    #[error("the panel {panel:?} has no conditions, and a measurement needs one")]
    NoConditions {
        /// Name of the panel.
        panel: String,
    },
    /// The panel has no condition of this number.
    #[error(
        "the number of a condition must be less than {conditions}, as many as the panel has, got {number}"
    )]
    NoSuchCondition {
        /// The number, from 0.
        number: usize,
        /// Number of conditions of the panel.
        conditions: usize,
    },
    /// No trial can run in the world under a condition.
    #[error("the condition {condition:?} of the panel cannot run in this world: {reason}")]
    Trial {
        /// Name of the condition.
        condition: String,
        /// Why no trial can run.
        reason: String,
    },
    /// A driver failed under a condition, which says nothing about the world.
    #[error("the driver failed under the condition {condition:?} of the panel: {reason}")]
    Driver {
        /// Name of the condition.
        condition: String,
        /// What the driver did.
        reason: String,
    },
    /// Trials fail in all easy anchors, or in all hard ones.
    #[error(
        "no {anchors} anchor can be mapped under every condition of the panel, and a scale needs one"
    )]
    NoAnchors {
        /// The anchors that fail: easy or hard.
        anchors: &'static str,
    },
    /// The scores of the anchors do not make a scale.
    #[error("the hard anchors must score more than the easy ones, got {hard} and {easy} of {dial}")]
    Scale {
        /// The dial.
        dial: &'static str,
        /// Mean score of the easy anchors.
        easy: f64,
        /// Mean score of the hard anchors.
        hard: f64,
    },
}

impl MeasureError {
    fn of_condition(condition: &Condition, failure: Failure) -> Self {
        let condition = condition.name.clone();
        match failure {
            Failure::World(reason) => MeasureError::Trial { condition, reason },
            Failure::Driver(reason) => MeasureError::Driver { condition, reason },
        }
    }
}

/// The measured difficulty of a world, with the data that it was computed from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measurement {
    /// The dials, with panel and noise.
    pub measured: MeasuredDifficulty,
    /// The mean scores D, M and N.
    pub scores: Dials<f64>,
    /// The means of each condition.
    pub conditions: Vec<ConditionMean>,
}

impl Measurement {
    /// Returns the dials with Student's 95 % intervals, by the noise of the trials.
    pub fn intervals(&self) -> Dials<(f64, [f64; 2])> {
        let trials = f64::from(self.measured.trials);
        let freedom = USUAL_WEIGHT + (trials - self.conditions.len() as f64).max(0.0);
        self.measured.dials.map(|Estimate { value, standard_error }| {
            let half = half_interval(standard_error, freedom);
            (value, [value - half, value + half])
        })
    }
}

/// The mean scores of one condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionMean {
    /// Its name.
    pub condition: String,
    /// The mean scores D, M and N.
    pub scores: Dials<f64>,
    /// Number of its trials that ended because nothing was left to explore.
    pub explored: u32,
    /// Mean fraction of the ground that its maps show as free. If little was covered, the scores say
    /// little about the world.
    pub coverage: f64,
}

/// What is kept of a trial.
#[derive(Clone, Copy)]
struct Scored {
    dials: Dials<f64>,
    is_explored: bool,
    coverage: f64,
}

/// A running measurement: the trials of a panel in a world, to which more can be added.
pub struct Measuring<'a> {
    site: Site,
    panel: &'a Panel,
    noise: Seed,
    /// The scores of every condition, one per seed.
    scores: Vec<Vec<Scored>>,
}

impl<'a> Measuring<'a> {
    /// Begins a measurement. The trials draw their noise from `noise` and the seeds after it, each from
    /// a seed of its own. Where more of the walls that the first condition's robot can see in a world
    /// that was not generated lie on borders of score cells than would lie there half a cell farther,
    /// the trials run in the world that is moved so: such a world is as difficult at one place as at
    /// another.
    pub fn new(world: &World, panel: &'a Panel, noise: Seed) -> Self {
        let default = Robot::default();
        let robot = panel.conditions.first().map_or(&default, |condition| &condition.robot);
        let world = placed(world, robot);
        let source = LogWorld::Given(Box::new(world.clone().into_owned()));
        let scores = vec![Vec::new(); panel.conditions.len()];
        Measuring { site: Site::new(world.into_owned(), source), panel, noise, scores }
    }

    /// Checks that a trial can start under every condition of the panel, which takes much less time than a
    /// trial. A driver is started, and gets the hello and the last line, but no observation.
    ///
    /// # Errors
    ///
    /// If no trial can run under one of the conditions, or if a driver cannot be started.
    pub fn check(&self) -> Result<(), MeasureError> {
        let mut conditions = self.panel.conditions.iter();
        conditions.try_for_each(|condition| {
            let checked = self.site.check(condition, self.noise);
            checked.map_err(|failure| MeasureError::of_condition(condition, failure))
        })
    }

    /// Runs one more trial under each of some conditions of the panel, by their numbers from 0, on all
    /// threads of the current pool.
    ///
    /// # Errors
    ///
    /// If the panel has no such condition, if no trial can run under one of them, or if a driver fails.
    /// No trial is added then.
    pub fn add(&mut self, conditions: &[usize]) -> Result<(), MeasureError> {
        let count = self.scores.len();
        if let Some(&number) = conditions.iter().find(|&&number| number >= count) {
            return Err(MeasureError::NoSuchCondition { number, conditions: count });
        }
        let run = |condition: usize| {
            let own = &self.panel.conditions[condition];
            // With the same noise under all conditions, noise would not average out.
            let count = self.panel.conditions.len() * self.scores[condition].len() + condition;
            let noise = self.noise.offset(count as u64);
            let outcome = self.site.run(own, noise);
            let outcome = outcome.map_err(|failure| MeasureError::of_condition(own, failure))?;
            let is_explored = outcome.end == Some(EndReason::Explored);
            let coverage = outcome.scores.coverage;
            Ok((condition, Scored { dials: scores(&outcome.scores), is_explored, coverage }))
        };
        let results: Result<Vec<_>, MeasureError> =
            conditions.to_vec().into_par_iter().map(run).collect();
        for (condition, result) in results? {
            self.scores[condition].push(result);
        }
        Ok(())
    }

    /// Returns the number of trials so far.
    pub fn trials(&self) -> usize {
        self.scores.iter().map(Vec::len).sum()
    }

    /// Returns the mean dials over the conditions that have a trial, all with the same weight; `None`
    /// before the first trial.
    pub fn dials(&self, scale: &Scale) -> Option<Dials<Estimate>> {
        let all = self.panel.conditions.iter().zip(&self.scores);
        let tried: Vec<(&Condition, &Vec<Scored>)> =
            all.filter(|(_, one)| !one.is_empty()).collect();
        if tried.is_empty() {
            return None;
        }
        // For the mean over conditions: each has the usual noise at its own scores.
        let usual = tried.iter().map(|(condition, one)| {
            usual_variance_under(condition, mean(one.iter().map(|one| one.dials)))
        });
        let usual = mean(usual);
        let estimate = |of: fn(&Dials<f64>) -> f64| {
            let values =
                tried.iter().map(|(_, one)| one.iter().map(|one| of(&one.dials)).collect());
            estimate(&values.collect::<Vec<_>>(), of(&usual))
        };
        let scores = Dials {
            difficulty: estimate(|scores| scores.difficulty),
            mapping: estimate(|scores| scores.mapping),
            navigation: estimate(|scores| scores.navigation),
        };
        let values = scale.dials(scores.map(|score| score.value));
        Some(scale.units().zip(scores.zip(values)).map(|(unit, (score, value))| Estimate {
            value,
            standard_error: unit.abs() * score.standard_error,
        }))
    }

    /// Returns the measurement; `None` as long as a condition has no trial.
    pub fn finish(&self, scale: &Scale) -> Option<Measurement> {
        if self.scores.iter().any(Vec::is_empty) {
            return None;
        }
        let dials = self.dials(scale)?;
        let conditions: Vec<ConditionMean> = self
            .panel
            .conditions
            .iter()
            .zip(&self.scores)
            .map(|(condition, trials)| ConditionMean {
                condition: condition.name.clone(),
                scores: mean(trials.iter().map(|trial| trial.dials)),
                explored: trials.iter().filter(|trial| trial.is_explored).count() as u32,
                coverage: trials.iter().map(|trial| trial.coverage).sum::<f64>()
                    / trials.len() as f64,
            })
            .collect();
        let measured = MeasuredDifficulty {
            panel: self.panel.name.clone(),
            panel_version: self.panel.version,
            dials,
            trials: self.trials() as u32,
            noise_seed: self.noise,
        };
        let scores = mean(conditions.iter().map(|one| one.scores));
        Some(Measurement { measured, scores, conditions })
    }
}

/// Measures a world with `seeds` trials under each condition, at least one.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::difficulty::{Panel, measure, reference_scale};
///
/// let room = HallwaySpec { segments: 1, pitch: 8.1, width: 8.0, ..Default::default() };
/// let world = room.generate(Seed(1))?.to_world();
/// let found = measure(&world, &Panel::reference(), reference_scale(), Seed(5), 1)?;
/// assert_eq!(found.measured.trials, 12);
/// assert!(found.measured.dials.difficulty.value.abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If the panel has no conditions; if no trial can run under one of them, since the world has no start
/// or the robot does not fit there; or if a driver fails.
pub fn measure(
    world: &World,
    panel: &Panel,
    scale: &Scale,
    noise: Seed,
    seeds: u32,
) -> Result<Measurement, MeasureError> {
    check_conditions(panel)?;
    let mut measuring = Measuring::new(world, panel, noise);
    let all: Vec<usize> = (0..panel.conditions.len()).collect();
    for _ in 0..seeds.max(1) {
        measuring.add(&all)?;
    }
    Ok(measuring.finish(scale).unwrap_or_else(|| unreachable!("every condition has a trial")))
}

/// Checks that a panel has conditions.
///
/// # Errors
///
/// Names the panel if it has none.
pub(super) fn check_conditions(panel: &Panel) -> Result<(), MeasureError> {
    if panel.conditions.is_empty() {
        return Err(MeasureError::NoConditions { panel: panel.name.clone() });
    }
    Ok(())
}

/// Returns the scores D, M and N of a trial.
pub(super) fn scores(scores: &Scores) -> Dials<f64> {
    Dials { difficulty: scores.difficulty, mapping: scores.mapping, navigation: scores.navigation }
}

/// Returns the mean of scores, which is 0 if there are none.
pub(super) fn mean(scores: impl Iterator<Item = Dials<f64>>) -> Dials<f64> {
    let (mut sum, mut count) = (Dials::<f64>::default(), 0.0);
    for one in scores {
        sum = one.zip(sum).map(|(a, b)| a + b);
        count += 1.0;
    }
    sum.map(|sum| if count > 0.0 { sum / count } else { 0.0 })
}

/// Returns the mean over conditions of their means, and its standard error by noise. It uses the
/// variance within conditions, shrunk towards the usual variance while it is known from few trials.
fn estimate(conditions: &[Vec<f64>], usual_variance: f64) -> Estimate {
    let count = conditions.len() as f64;
    let (mut value, mut squares, mut freedom, mut inverse) = (0.0, 0.0, 0.0, 0.0);
    for trials in conditions {
        let n = trials.len() as f64;
        let mean = trials.iter().sum::<f64>() / n;
        value += mean / count;
        squares += trials.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        freedom += n - 1.0;
        inverse += 1.0 / n;
    }
    let variance = (squares + USUAL_WEIGHT * usual_variance) / (freedom + USUAL_WEIGHT);
    Estimate { value, standard_error: (variance * inverse).sqrt() / count }
}

#[cfg(test)]
mod tests {
    use envgen::hallway::HallwaySpec;
    use envgen::{Blueprint, Spec};
    use proptest::prelude::*;

    use super::*;
    use crate::difficulty::reference_scale;

    #[test]
    fn conditions_count_the_same_however_many_trials_they_have() {
        let found = estimate(&[vec![2.0], vec![4.0, 4.0, 4.0, 4.0]], 0.25);
        assert_eq!(found.value, 3.0);
        // Three degrees of freedom without any spread, six with the usual one.
        let variance = 6.0 * 0.25 / 9.0;
        assert!((found.standard_error - (variance * 1.25_f64).sqrt() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_panel_without_conditions_measures_nothing() {
        let mut panel = Panel::reference();
        panel.conditions.clear();
        let world = HallwaySpec { segments: 1, ..Default::default() };
        let world = world.generate(Seed(1)).expect("a hallway").to_world();
        let found = measure(&world, &panel, reference_scale(), Seed(5), 1);
        let error = found.expect_err("no conditions");
        assert_eq!(error, MeasureError::NoConditions { panel: "reference".to_owned() });
        let text = error.to_string();
        assert_eq!(text, "the panel \"reference\" has no conditions, and a measurement needs one");
        let mut measuring = Measuring::new(&world, &panel, Seed(5));
        assert_eq!(measuring.add(&[]), Ok(()));
        assert_eq!((measuring.dials(reference_scale()), measuring.trials()), (None, 0));
        assert_eq!(measuring.finish(reference_scale()), None);
    }

    proptest! {
        #[test]
        fn a_condition_that_the_panel_lacks_is_named(
            number in prop_oneof![12..99_usize, any::<usize>().prop_map(|n| n.max(12))],
            place in 0..3_usize,
        ) {
            let panel = Panel::reference();
            let world = HallwaySpec { segments: 1, ..Default::default() };
            let world = world.generate(Seed(1)).expect("a hallway").to_world();
            let mut measuring = Measuring::new(&world, &panel, Seed(5));
            let mut numbers = vec![0, 11];
            numbers.insert(place, number);
            let error = measuring.add(&numbers).expect_err("no such condition");
            prop_assert_eq!(&error, &MeasureError::NoSuchCondition { number, conditions: 12 });
            let text = format!("must be less than 12, as many as the panel has, got {number}");
            prop_assert!(error.to_string().ends_with(&text), "{}", error);
            prop_assert_eq!(measuring.trials(), 0);
        }
    }

    #[test]
    fn every_trial_has_noise_of_its_own() {
        let mut panel = Panel::reference();
        panel.conditions.truncate(1);
        panel.conditions.push(panel.conditions[0].clone());
        let world = HallwaySpec { segments: 3, ..Default::default() };
        let world = world.generate(Seed(1)).expect("a hallway").to_world();
        let mut measuring = Measuring::new(&world, &panel, Seed(5));
        for _ in 0..2 {
            measuring.add(&[0, 1]).expect("trials");
        }
        let mut scores: Vec<f64> =
            measuring.scores.concat().iter().map(|trial| trial.dials.difficulty).collect();
        scores.sort_by(f64::total_cmp);
        assert!(scores.windows(2).all(|pair| pair[0] < pair[1]), "{scores:?}");
    }

    #[test]
    fn the_failure_of_a_driver_is_not_the_worlds() {
        let mut panel = Panel::reference();
        panel.conditions.truncate(1);
        panel.conditions[0].driver = Some("no-such-program".to_owned());
        let room = HallwaySpec { segments: 1, pitch: 8.1, width: 8.0, ..Default::default() };
        let world = room.generate(Seed(1)).expect("a room").to_world();
        let mut measuring = Measuring::new(&world, &panel, Seed(1));
        let text = measuring.add(&[0]).expect_err("no driver").to_string();
        let start = "the driver failed under the condition \"nearest, lms200_mm\" of the panel: it cannot be started: \"no-such-program\": ";
        assert!(text.starts_with(start), "{text}");
        assert_eq!(measuring.check().expect_err("no driver").to_string(), text);
    }

    #[test]
    fn spread_within_conditions_is_noise_and_spread_between_them_is_not() {
        let within = estimate(&vec![vec![1.0, 3.0]; 40], 0.25);
        assert!((within.standard_error - (2.0_f64 / 80.0).sqrt()).abs() < 0.02, "{within:?}");
        let between = estimate(&[vec![0.0; 40], vec![9.0; 40]], 0.25);
        assert!(between.standard_error < 0.03, "{between:?}");
    }
}
