//! The summary of a survey: how trials ended, and how much of the variance is due to the worlds.

use std::collections::BTreeMap;

use serde::Serialize;
use statrs::statistics::{Data, OrderStatistics};

use super::design::{Condition, Survey, SurveyNoise};
use super::ranks::{Ranks, ranks};
use super::record::Record;
use crate::experiment::stats::{Factorial, MEASURES, MeasureComponents, components};
use crate::score::Scores;
use crate::trial::EndReason;

/// Coverage from which a world counts as explored.
const EXPLORED: f64 = 0.95;

/// Trajectory error in metres above which a robot counts as lost.
const LOST: f64 = 2.0;

/// All results of a survey.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Results of each family and condition.
    pub groups: Vec<Group>,
    /// Variance components of each measure, over the worlds whose trials all have scores, also of a
    /// survey that is not complete; empty for fewer than two such worlds, or without repeated trials.
    pub measures: Vec<MeasureComponents>,
    /// The order of the worlds by score 1 and by score 2, over the worlds whose trials all have scores;
    /// absent for fewer than two.
    pub ranks: Option<Ranks>,
    /// The trials in which something went wrong.
    pub faults: Vec<Fault>,
}

/// The trials of one condition in one family.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Group {
    /// Name of the family.
    pub family: String,
    /// Name of the condition.
    pub condition: String,
    /// Number of finished trials.
    pub trials: usize,
    /// Number of trials by end reason.
    pub ends: BTreeMap<EndReason, usize>,
    /// Number of trials without scores.
    pub failures: usize,
    /// Means over the trials with scores; `None` if there are none.
    pub mean: Option<Means>,
    /// Median of the trajectory error in metres; `None` if there are no scores.
    pub median_error: Option<f64>,
    /// 90 % quantile of the trajectory error in metres; `None` if there are no scores.
    pub high_error: Option<f64>,
}

/// Means over trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Means {
    /// D.
    pub difficulty: f64,
    /// M.
    pub mapping: f64,
    /// N.
    pub navigation: f64,
    /// D, M and N by score 1.
    pub score_1: [f64; 3],
    /// C, the coverage.
    pub coverage: f64,
    /// Simulated time in seconds.
    pub time: f64,
}

/// A kind of fault in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// No trial could run.
    Failed,
    /// The trial ended as explored with a coverage below 0.95, although the robot was not lost: the
    /// trajectory error is at most 2 m.
    ExploredTooEarly,
    /// The trial ended as stuck, although the robot was not lost.
    StuckWithGoodPose,
    /// The robot was lost: the trajectory error is above 2 m.
    Lost,
}

/// A trial with a fault.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Name of the family.
    pub family: String,
    /// Name of the condition.
    pub condition: String,
    /// The trial.
    pub record: Record,
}

/// Summarises the finished trials of a survey, which are sorted by world, condition and noise.
///
/// # Panics
///
/// If a trial does not belong to the survey.
#[track_caller]
pub fn summarise(survey: &Survey, records: &[&Record]) -> Summary {
    let mut families = Vec::new();
    for (number, family) in survey.families.iter().enumerate() {
        families.extend((0..family.maps).map(|_| number));
    }
    let mut grouped: BTreeMap<(usize, usize), Vec<&Record>> = BTreeMap::new();
    for &record in records {
        let key = (families[record.map as usize], record.condition as usize);
        grouped.entry(key).or_default().push(record);
    }
    let names = |(family, condition): (usize, usize)| {
        (survey.families[family].name.clone(), survey.conditions[condition].name.clone())
    };
    let groups = grouped.iter().map(|(&key, own)| {
        let (family, condition) = names(key);
        group(family, condition, own)
    });
    let groups = groups.collect();
    let mut faults: Vec<Fault> = records
        .iter()
        .filter_map(|record| {
            let kind = fault(record)?;
            let key = (families[record.map as usize], record.condition as usize);
            let (family, condition) = names(key);
            Some(Fault { kind, family, condition, record: (*record).clone() })
        })
        .collect();
    faults.sort_by_key(|fault| fault.kind);
    let worlds = complete(survey, records);
    let names: Vec<&str> = survey.families.iter().map(|family| family.name.as_str()).collect();
    let of_families: Vec<(usize, &[&Record])> =
        worlds.iter().map(|&trials| (families[trials[0].map as usize], trials)).collect();
    let ranks = ranks(&names, &of_families);
    Summary { groups, measures: measures(survey, &worlds), ranks, faults }
}

/// Returns the fault of a trial, if it has one.
pub fn fault(record: &Record) -> Option<FaultKind> {
    let Some(scores) = &record.scores else { return Some(FaultKind::Failed) };
    if scores.trajectory_error > LOST {
        return Some(FaultKind::Lost);
    }
    match record.end {
        Some(EndReason::Explored) if scores.coverage < EXPLORED => {
            Some(FaultKind::ExploredTooEarly)
        }
        Some(EndReason::Stuck) => Some(FaultKind::StuckWithGoodPose),
        _ => None,
    }
}

fn group(family: String, condition: String, records: &[&Record]) -> Group {
    let mut group = Group { family, condition, trials: records.len(), ..Group::default() };
    for end in records.iter().filter_map(|record| record.end) {
        *group.ends.entry(end).or_insert(0) += 1;
    }
    let scores: Vec<&Scores> = records.iter().filter_map(|record| record.scores.as_ref()).collect();
    group.failures = records.len() - scores.len();
    if scores.is_empty() {
        return group;
    }
    let mean = |of: fn(&Scores) -> f64| {
        scores.iter().map(|scores| of(scores)).sum::<f64>() / scores.len() as f64
    };
    group.mean = Some(Means {
        difficulty: mean(|s| s.difficulty),
        mapping: mean(|s| s.mapping),
        navigation: mean(|s| s.navigation),
        score_1: [
            mean(|s| s.score_1.difficulty),
            mean(|s| s.score_1.mapping),
            mean(|s| s.score_1.navigation),
        ],
        coverage: mean(|s| s.coverage),
        time: mean(|s| s.time),
    });
    let errors: Vec<f64> = scores.iter().map(|scores| scores.trajectory_error).collect();
    let mut errors = Data::new(errors);
    group.median_error = Some(errors.quantile(0.5));
    group.high_error = Some(errors.quantile(0.9));
    group
}

/// A facet of the conditions: its name, and its level in a condition.
type Facet = (&'static str, fn(&Condition) -> String);

const FACETS: [Facet; 4] = [
    // A driver drives in place of the policy, whichever that is.
    ("policy", |one| match &one.driver {
        Some(line) => format!("driver {line}"),
        None => format!("{:?}", one.policy),
    }),
    ("laser", |one| format!("{:?}", one.laser)),
    ("odometry", |one| format!("{:?}", one.odometry)),
    ("SLAM", |one| format!("{:?}", one.slam)),
];

/// Returns the factors of the conditions with the number of their levels, and the number of the
/// condition for each combination. If the conditions are not all combinations of policy, laser,
/// odometry and SLAM, or if they differ in anything else, they are the levels of one factor.
fn factors(conditions: &[Condition]) -> (Vec<(&'static str, usize)>, Vec<usize>) {
    let single = || (vec![("condition", conditions.len())], (0..conditions.len()).collect());
    let mut facets = Vec::new();
    for (name, level) in FACETS {
        let mut levels: Vec<String> = Vec::new();
        for condition in conditions {
            let level = level(condition);
            if !levels.contains(&level) {
                levels.push(level);
            }
        }
        if levels.len() > 1 {
            facets.push((name, level, levels));
        }
    }
    let combinations: usize = facets.iter().map(|(_, _, levels)| levels.len()).product();
    let differ_elsewhere = conditions.iter().zip(conditions.iter().skip(1)).any(|(one, next)| {
        let Condition { name, policy, driver, laser, odometry, slam, .. } = one.clone();
        one != &Condition { name, policy, driver, laser, odometry, slam, ..next.clone() }
    });
    if facets.is_empty() || combinations != conditions.len() || differ_elsewhere {
        return single();
    }
    let mut order = vec![usize::MAX; combinations];
    for (number, condition) in conditions.iter().enumerate() {
        let place = facets.iter().fold(0, |place, (_, level, levels)| {
            let own = level(condition);
            place * levels.len() + levels.iter().position(|one| *one == own).unwrap_or(0)
        });
        order[place] = number;
    }
    if order.contains(&usize::MAX) {
        return single();
    }
    (facets.into_iter().map(|(name, _, levels)| (name, levels.len())).collect(), order)
}

/// The trials of each world whose trials all have scores.
fn complete<'a, 'b>(survey: &Survey, records: &'a [&'b Record]) -> Vec<&'a [&'b Record]> {
    let per_map = survey.conditions.len() * survey.noise_seeds as usize;
    let whole =
        |map: &&[&Record]| map.len() == per_map && map.iter().all(|record| record.scores.is_some());
    records.chunk_by(|a, b| a.map == b.map).filter(whole).collect()
}

fn measures(survey: &Survey, maps: &[&[&Record]]) -> Vec<MeasureComponents> {
    let (conditions, order) = factors(&survey.conditions);
    let repeats = survey.noise_seeds as usize;
    let mut sizes = vec![maps.len()];
    let mut factors = vec!["map"];
    for (name, levels) in conditions.into_iter().filter(|(_, levels)| *levels > 1) {
        factors.push(name);
        sizes.push(levels);
    }
    let of = |measure: fn(&Scores) -> f64| {
        let values = maps.iter().flat_map(|map| {
            order.iter().flat_map(move |&condition| {
                let trials = &map[condition * repeats..(condition + 1) * repeats];
                trials.iter().filter_map(move |record| record.scores.as_ref().map(measure))
            })
        });
        let (factors, sizes) = (factors.clone(), sizes.clone());
        components(&Factorial {
            factors,
            sizes,
            repeats,
            shares_noise: survey.noise == SurveyNoise::Shared,
            values: values.collect(),
        })
    };
    let measures = MEASURES.iter().filter_map(|measure| {
        Some(MeasureComponents { symbol: measure.symbol, components: of(measure.of)? })
    });
    measures.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::LaserProfile;
    use crate::names::Named;
    use crate::policy::PolicyKind;

    #[test]
    fn a_driver_is_the_policy_whatever_the_field_says() {
        let with = |policy, driver: Option<&str>, laser: &str| Condition {
            policy,
            driver: driver.map(str::to_owned),
            laser: LaserProfile::named(laser).expect("a laser"),
            ..Condition::default()
        };
        let (nearest, cautious) = (PolicyKind::Nearest, PolicyKind::Cautious);
        let names = |conditions: &[Condition]| factors(conditions).0;
        // One driver under two names of policies is no factor that explains anything.
        let same = [with(nearest, Some("a"), "usarsim"), with(cautious, Some("a"), "usarsim")];
        assert_eq!(names(&same), [("condition", 2)]);
        let drivers = [Some("a"), Some("b"), None];
        let crossed: Vec<Condition> = ["usarsim", "urg_04lx"]
            .iter()
            .flat_map(|laser| drivers.map(|driver| with(nearest, driver, laser)))
            .collect();
        assert_eq!(names(&crossed), [("policy", 3), ("laser", 2)]);
    }
}
