//! The statistics of an experiment.
//!
//! The unit of every statistic is the map: trials on one map that differ in noise or policy are
//! averaged first, since they are not independent. Intervals are of 95 %: Student's t for means of a level,
//! the percentile bootstrap over maps, drawn within their levels, for everything else (Efron and
//! Tibshirani, An Introduction to the Bootstrap, 1993, chapters 13 and 14).

mod components;
mod measure;
mod order;
mod rank;
mod regression;
mod resample;
mod rules;
mod triples;
mod variance;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

pub use components::{Component, Components, Factorial, MeasureComponents, components};
pub use measure::{MEASURES, MapValues, Measure, map_values};
pub use order::{Mean, Order, Verdict, order};
pub(crate) use order::{half_interval, mean_and_half};
pub(crate) use rank::pearson;
pub(super) use rank::ranks;
pub use rank::{Null, spearman};
pub(crate) use resample::bootstrap;
pub use resample::{Interval, RESAMPLES};
pub use rules::{FEATURES, Feature, FeatureEffect, Slope, effects};
pub use triples::{Relative, relative};
pub use variance::{Shares, shares};

use super::design::{Design, TrialId, policy_name};
use super::record::Record;
use crate::score::{Parts, Sensitivity, Weights, sensitivity};
use crate::trial::EndReason;

/// All statistics of an experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// The paper's design.
    pub replay: Part,
    /// The larger design.
    pub main: Part,
    /// How each rule's feature changes with the level, and its effect on the larger design's scores.
    pub rules: Vec<FeatureEffect>,
    /// How the ranking of the larger design's maps changes with the weights of the scores.
    pub weights: Vec<Weighting>,
    /// How each level's trials ended, all trials counted once.
    pub ends: Vec<EndCounts>,
}

/// How a level's trials ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EndCounts {
    /// Number of trials.
    pub trials: usize,
    /// Number of trials by end reason.
    pub reasons: BTreeMap<EndReason, usize>,
    /// Mean simulated time in seconds.
    pub time: f64,
}

impl EndCounts {
    /// The share of trials that ended because the robot was lost: stuck or in water.
    pub fn share_lost(&self) -> f64 {
        let lost = [EndReason::Stuck, EndReason::Drowned];
        let lost: usize = lost.iter().filter_map(|reason| self.reasons.get(reason)).sum();
        lost as f64 / self.trials.max(1) as f64
    }
}

/// The statistics of one design.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// Maps per level.
    pub maps: usize,
    /// Noise seeds per map.
    pub noise_seeds: usize,
    /// Number of trials.
    pub trials: usize,
    /// The least rank correlation of different values that chance reaches in at most 5 % of cases; `None` where it
    /// reaches even the greatest more often.
    pub critical_rho: Option<f64>,
    /// For each measure, over all policies.
    pub orders: Vec<Order>,
    /// For each measure of which trials are repeated: which part of the variance of single trials
    /// belongs to the maps of all levels, to the policies, to both together, and to noise.
    pub components: Vec<MeasureComponents>,
    /// For D, M and N, by policy; `operators` in files.
    #[serde(rename = "operators")]
    pub policies: Vec<PolicyOrders>,
    /// The order of three maps of different levels, for D, M and N.
    pub relative: Vec<Relative>,
    /// The mean of each map.
    #[serde(skip)]
    pub values: Vec<MapValues>,
}

/// The orders of one policy.
#[derive(Clone, Debug, Serialize)]
pub struct PolicyOrders {
    /// Its name, `operator` in files.
    #[serde(rename = "operator")]
    pub policy: &'static str,
    /// For D, M and N.
    pub orders: Vec<Order>,
}

/// How the ranking of maps by D changes when one weight changes by half.
#[derive(Clone, Debug, Serialize)]
pub struct Weighting {
    /// The change of the ranking.
    #[serde(flatten)]
    pub sensitivity: Sensitivity,
    /// Spearman's correlation of level and D with the changed weight.
    pub rho: Option<f64>,
}

/// Computes all statistics of a complete experiment.
pub fn analyse(design: &Design, records: &[&Record]) -> Analysis {
    let pick = |which: &dyn Fn(&TrialId) -> bool| -> Vec<&Record> {
        records.iter().filter(|record| which(&record.trial)).copied().collect()
    };
    let replay = pick(&|trial| design.is_replay(trial));
    let main = pick(&|trial| design.is_main(trial));
    let ends = (0..design.levels.len()).map(|level| {
        pick(&|trial| trial.level as usize == level).into_iter().fold(
            EndCounts::default(),
            |mut ends, record| {
                ends.trials += 1;
                ends.time += (record.scores.time - ends.time) / ends.trials as f64;
                if let Some(reason) = record.end {
                    *ends.reasons.entry(reason).or_insert(0) += 1;
                }
                ends
            },
        )
    });
    let ends = ends.collect();
    let main = part(design, &main);
    Analysis {
        replay: part(design, &replay),
        rules: effects(design, &main.values),
        weights: weightings(design, &main.values),
        main,
        ends,
    }
}

fn part(design: &Design, records: &[&Record]) -> Part {
    let values = map_values(records);
    let different: Vec<f64> = (0..values.len()).map(|map| map as f64).collect();
    let count = |of: &dyn Fn(&TrialId) -> u32| {
        records.iter().map(|record| of(&record.trial) as usize + 1).max().unwrap_or(0)
    };
    let policies = MEASURED_POLICIES.iter().filter_map(|&(policy, kind)| {
        let own: Vec<&Record> =
            records.iter().filter(|r| r.trial.policy == kind).copied().collect();
        let values = map_values(&own);
        let main = MEASURES.iter().take(3);
        let orders = main.map(|measure| order(design, measure, &own, &values)).collect();
        (!own.is_empty()).then_some(PolicyOrders { policy, orders })
    });
    Part {
        maps: count(&|trial| trial.map),
        noise_seeds: count(&|trial| trial.noise),
        trials: records.len(),
        critical_rho: Null::new(design, &values, &different).critical(),
        orders: MEASURES.iter().map(|measure| order(design, measure, records, &values)).collect(),
        components: variance_components(records),
        policies: policies.collect(),
        relative: MEASURES.iter().take(3).map(|measure| relative(measure, records)).collect(),
        values,
    }
}

/// The components of maps and policies, if each policy drove as often on each map.
fn variance_components(records: &[&Record]) -> Vec<MeasureComponents> {
    let maps: Vec<&[&Record]> = records
        .chunk_by(|a, b| (a.trial.level, a.trial.map) == (b.trial.level, b.trial.map))
        .collect();
    let policies: BTreeSet<&str> = records.iter().map(|record| policy_of(record)).collect();
    let repeats = records.len() / (maps.len() * policies.len()).max(1);
    let of = |measure: &Measure| {
        let mut values = Vec::with_capacity(records.len());
        for map in &maps {
            for policy in &policies {
                let own = map.iter().filter(|record| policy_of(record) == *policy);
                let before = values.len();
                values.extend(own.map(|record| (measure.of)(&record.scores)));
                if values.len() - before != repeats {
                    return None;
                }
            }
        }
        let (mut factors, mut sizes) = (vec!["map"], vec![maps.len()]);
        if policies.len() > 1 {
            factors.push("policy");
            sizes.push(policies.len());
        }
        // Noise is the same for all policies.
        let design = Factorial { factors, sizes, repeats, shares_noise: true, values };
        let components = components(&design)?;
        Some(MeasureComponents { symbol: measure.symbol, components })
    };
    MEASURES.iter().filter_map(of).collect()
}

/// The policies by name.
const MEASURED_POLICIES: &[(&str, crate::policy::PolicyKind)] =
    <crate::policy::PolicyKind as crate::names::Named>::NAMES;

fn weightings(design: &Design, values: &[MapValues]) -> Vec<Weighting> {
    // D is linear in its parts: the D of mean parts is the mean D.
    let parts: Vec<Parts> = values.iter().map(MapValues::parts).collect();
    let levels: Vec<f64> = values.iter().map(|map| design.levels[map.level]).collect();
    let found = sensitivity(&parts, Weights::default());
    let rho = |found: &Sensitivity| {
        let weights = Weights::default().changed(found.weight, found.factor)?;
        let d: Vec<f64> = parts.iter().map(|parts| weights.difficulties(parts).overall).collect();
        spearman(&levels, &d)
    };
    found.into_iter().map(|s| Weighting { rho: rho(&s), sensitivity: s }).collect()
}

/// The name of a policy in tables.
pub(super) fn policy_of(record: &Record) -> &'static str {
    policy_name(record.trial.policy)
}
