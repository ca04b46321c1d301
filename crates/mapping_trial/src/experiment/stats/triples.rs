//! The order of three maps of different levels, as found by each policy.

use std::collections::BTreeMap;

use serde::Serialize;

use super::measure::Measure;
use crate::experiment::record::Record;
use crate::policy::PolicyKind;

/// The mean ranks of the easiest, the middle and the hardest of three maps by their levels. They are 1,
/// 2 and 3 if every policy finds every three in order, and all 2 by chance. Ties share ranks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Relative {
    /// Symbol of the measure.
    pub measure: &'static str,
    /// Mean ranks.
    pub ranks: [f64; 3],
}

/// Ranks all triples of maps of different levels within each policy.
///
/// A map's rank among three is 1, plus 1 for each of the other two that is easier. Mean ranks therefore
/// follow from comparisons of pairs, which takes O(n^2) time for n maps, not O(n^3), and from the triples
/// of levels.
pub fn relative(measure: &Measure, records: &[&Record]) -> Relative {
    // Means over noise, by policy, level and map.
    let mut maps: BTreeMap<(PolicyKind, u32, u32), (f64, f64)> = BTreeMap::new();
    for record in records {
        let trial = record.trial;
        let (sum, count) = maps.entry((trial.policy, trial.level, trial.map)).or_default();
        *sum += (measure.of)(&record.scores);
        *count += 1.0;
    }
    let mut policies: BTreeMap<PolicyKind, BTreeMap<u32, Vec<f64>>> = BTreeMap::new();
    for ((policy, level, _), (sum, count)) in maps {
        policies.entry(policy).or_default().entry(level).or_default().push(sum / count);
    }
    let (mut sums, mut count) = ([0.0; 3], 0.0);
    for levels in policies.into_values() {
        let levels: Vec<Vec<f64>> = levels.into_values().collect();
        let share_over = |a: &Vec<f64>| levels.iter().map(|b| share_harder(a, b)).collect();
        let shares: Vec<Vec<f64>> = levels.iter().map(share_over).collect();
        for c in 0..levels.len() {
            for b in 0..c {
                for a in 0..b {
                    let (ba, ca, cb) = (shares[b][a], shares[c][a], shares[c][b]);
                    let ranks = [3.0 - ba - ca, 2.0 + ba - cb, 1.0 + ca + cb];
                    sums.iter_mut().zip(ranks).for_each(|(sum, rank)| *sum += rank);
                    count += 1.0;
                }
            }
        }
    }
    // With two levels there are no triples.
    let ranks = if count > 0.0 { sums.map(|sum| sum / count) } else { [2.0; 3] };
    Relative { measure: measure.symbol, ranks }
}

/// The fraction of pairs in which the first is greater. Ties count half.
fn share_harder(these: &[f64], those: &[f64]) -> f64 {
    let pairs = these.iter().flat_map(|a| those.iter().map(move |b| (a, b)));
    let wins: f64 = pairs
        .map(|(a, b)| {
            if a > b {
                1.0
            } else if a == b {
                0.5
            } else {
                0.0
            }
        })
        .sum();
    wins / (these.len() * those.len()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::stats::MEASURES;
    use crate::experiment::tests::record;

    /// Every three maps one after the other.
    fn by_hand(records: &[Record]) -> [f64; 3] {
        let d = |record: &Record| record.scores.difficulty;
        let rank = |of: &Record, all: [&Record; 3]| {
            let easier = all.iter().map(|other| {
                if d(other) < d(of) {
                    1.0
                } else if d(other) == d(of) {
                    0.5
                } else {
                    0.0
                }
            });
            0.5 + easier.sum::<f64>()
        };
        let (mut sums, mut count) = ([0.0; 3], 0.0);
        for a in records {
            for b in records.iter().filter(|b| b.trial.level > a.trial.level) {
                for c in records.iter().filter(|c| c.trial.level > b.trial.level) {
                    let all = [a, b, c];
                    for (sum, of) in sums.iter_mut().zip(all) {
                        *sum += rank(of, all);
                    }
                    count += 1.0;
                }
            }
        }
        sums.map(|sum| sum / count)
    }

    #[test]
    fn pairs_give_what_triples_give() {
        let values = [3.0, 4.0, 2.0, 4.0, 9.0, 1.0, 4.0, 7.0];
        let records: Vec<Record> =
            (0..8).map(|i| record(i as u32 / 2, i as u32 % 2, 0, values[i])).collect();
        let found = relative(&MEASURES[0], &records.iter().collect::<Vec<_>>());
        for (a, b) in found.ranks.iter().zip(by_hand(&records)) {
            assert!((a - b).abs() < 1e-12, "{found:?}");
        }
        let rising: Vec<Record> = (0..5).map(|i| record(i, 0, 0, f64::from(i))).collect();
        let found = relative(&MEASURES[0], &rising.iter().collect::<Vec<_>>());
        assert_eq!(found.ranks, [1.0, 2.0, 3.0]);
    }
}
