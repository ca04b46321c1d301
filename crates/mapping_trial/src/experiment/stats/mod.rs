//! The statistics of an experiment.
//!
//! The unit of every statistic is the map. Trials on one map that differ in noise or policy are
//! averaged first, since they are not independent. Intervals have a level of 95 %: they are by
//! Student's t for means of a level, by the jackknife over maps for components of the variance (Arvesen
//! and Schmitz, 1970), and by the percentile bootstrap over maps, drawn within their levels, for everything
//! else (Efron and Tibshirani, An Introduction to the Bootstrap, 1993, chapters 13 and 14).

mod components;
mod factorial;
mod fraction;
mod jackknife;
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

pub use components::{Component, Components, MeasureComponents, components};
pub use factorial::Factorial;
pub(crate) use fraction::fraction;
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
    /// The statistics of the paper's design.
    pub replay: Part,
    /// The statistics of the larger design.
    pub main: Part,
    /// How the feature of each rule changes with the level, and its effect on the scores of the larger
    /// design.
    pub rules: Vec<FeatureEffect>,
    /// How the ranking of the larger design's maps changes with the weights of the scores.
    pub weights: Vec<Weighting>,
    /// How the trials of each level ended, with every trial counted once.
    pub ends: Vec<EndCounts>,
}

/// How the trials of a level ended.
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
    /// Returns the fraction of trials that ended because the robot was lost: stuck or in water.
    pub fn share_lost(&self) -> f64 {
        let lost = [EndReason::Stuck, EndReason::Drowned];
        let lost: usize = lost.iter().filter_map(|reason| self.reasons.get(reason)).sum();
        lost as f64 / self.trials.max(1) as f64
    }
}

/// The statistics of one design.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// Number of maps per level.
    pub maps: usize,
    /// Number of noise seeds per map.
    pub noise_seeds: usize,
    /// Number of trials.
    pub trials: usize,
    /// Critical value of the rank correlation: the least one of different values that chance reaches in
    /// at most 5 % of cases; `None` if chance reaches even the greatest one more often.
    pub critical_rho: Option<f64>,
    /// The order in each measure, over all policies.
    pub orders: Vec<Order>,
    /// Variance components of each measure, if trials are repeated: the parts of the variance of single
    /// trials that belong to the maps of all levels, to the policies, to both together, and to noise.
    pub components: Vec<MeasureComponents>,
    /// The orders in D, M and N, by policy. The name in files is `operators`.
    #[serde(rename = "operators")]
    pub policies: Vec<PolicyOrders>,
    /// The order of three maps of different levels, for D, M and N.
    pub relative: Vec<Relative>,
    /// The means of each map.
    #[serde(skip)]
    pub values: Vec<MapValues>,
}

/// The orders of one policy.
#[derive(Clone, Debug, Serialize)]
pub struct PolicyOrders {
    /// Name of the policy. Its name in files is `operator`.
    #[serde(rename = "operator")]
    pub policy: &'static str,
    /// The orders in D, M and N.
    pub orders: Vec<Order>,
}

/// How the ranking of maps by D changes when one weight changes by half.
#[derive(Clone, Debug, Serialize)]
pub struct Weighting {
    /// The change of the ranking.
    #[serde(flatten)]
    pub sensitivity: Sensitivity,
    /// Spearman's correlation between level and D, with the changed weight.
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

/// The variance components of maps and policies, if each policy drove equally often on each map.
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
        // The noise is the same for all policies.
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
    // D is linear in its parts, so that the D of mean parts is the mean D.
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
