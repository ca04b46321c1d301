//! How the order of a survey's worlds differs between score 1 and score 2, which is the default.

use std::collections::BTreeMap;

use envgen::Seed;
use serde::Serialize;

use super::record::Record;
use crate::experiment::error::ExperimentError;
use crate::experiment::stats;
use crate::score::{Scores, kendall_tau};

type Measured = fn(&Scores) -> f64;

/// D, M and N, each by score 1 and by score 2.
const PAIRS: [[Measured; 2]; 3] = [
    [|s| s.score_1.difficulty, |s| s.difficulty],
    [|s| s.score_1.mapping, |s| s.mapping],
    [|s| s.score_1.navigation, |s| s.navigation],
];

/// The order of the worlds by the mean scores of their trials.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranks {
    /// Number of worlds.
    pub worlds: usize,
    /// Kendall's tau-b between the orders by score 1 and by score 2, for D, M and N; absent if all
    /// values of one of them are equal.
    pub tau: [Option<f64>; 3],
    /// Ranks of each family.
    pub families: Vec<FamilyRanks>,
    /// Ranks of each world.
    pub each: Vec<WorldRanks>,
}

/// The mean ranks of a family's worlds among all worlds, where 1 is the easiest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyRanks {
    /// Name of the family.
    pub family: String,
    /// Ranks by D of score 1 and of score 2.
    pub difficulty: [f64; 2],
    /// Ranks by M, likewise.
    pub mapping: [f64; 2],
    /// Ranks by N, likewise.
    pub navigation: [f64; 2],
}

/// The ranks of a world among all worlds, where 1 is the easiest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorldRanks {
    /// Name of its family.
    pub family: String,
    /// Its seed.
    pub world_seed: Seed,
    /// Ranks by D of score 1 and of score 2.
    pub difficulty: [f64; 2],
    /// Ranks by M, likewise.
    pub mapping: [f64; 2],
    /// Ranks by N, likewise.
    pub navigation: [f64; 2],
}

impl Ranks {
    /// Returns the ranks of every world as CSV (RFC 4180).
    ///
    /// # Errors
    ///
    /// [`ExperimentError::Report`] if the rows cannot be written.
    pub fn csv(&self) -> Result<Vec<u8>, ExperimentError> {
        let failed = |error: csv::Error| ExperimentError::Report(error.to_string());
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(CSV_HEAD).map_err(failed)?;
        for world in &self.each {
            let mut row = vec![world.family.clone(), world.world_seed.to_string()];
            let ranks = [world.difficulty, world.mapping, world.navigation];
            row.extend(ranks.iter().flatten().map(f64::to_string));
            writer.write_record(row).map_err(failed)?;
        }
        writer.into_inner().map_err(|error| ExperimentError::Report(error.error().to_string()))
    }
}

/// The columns of [`Ranks::csv`].
const CSV_HEAD: [&str; 8] =
    ["family", "world_seed", "rank_D1", "rank_D", "rank_M1", "rank_M", "rank_N1", "rank_N"];

/// Ranks worlds, each given by the number of its family and all its trials; `None` for fewer than two
/// worlds, or if a score is NaN.
pub(super) fn ranks(names: &[&str], worlds: &[(usize, &[&Record])]) -> Option<Ranks> {
    if worlds.len() < 2 {
        return None;
    }
    let means = |of: Measured| -> Vec<f64> {
        let mean = |trials: &[&Record]| {
            let scores = trials.iter().filter_map(|trial| trial.scores.as_ref());
            scores.map(of).sum::<f64>() / trials.len() as f64
        };
        worlds.iter().map(|(_, trials)| mean(trials)).collect()
    };
    let values = PAIRS.map(|pair| pair.map(means));
    let [difficulty, mapping, navigation] = values.each_ref().map(|[one, two]| {
        let (one, two) = stats::ranks(one).zip(stats::ranks(two))?;
        Some([one, two])
    });
    let places = [difficulty?, mapping?, navigation?];
    // The worlds of each family.
    let mut by_family: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, (family, _)) in worlds.iter().enumerate() {
        by_family.entry(*family).or_default().push(i);
    }
    let family = |(number, own): (usize, Vec<usize>)| {
        let [difficulty, mapping, navigation] = places.each_ref().map(|pair| {
            pair.each_ref().map(|all| own.iter().map(|&i| all[i]).sum::<f64>() / own.len() as f64)
        });
        FamilyRanks { family: names[number].to_owned(), difficulty, mapping, navigation }
    };
    let world = |i: usize| {
        let [difficulty, mapping, navigation] =
            places.each_ref().map(|pair| pair.each_ref().map(|all| all[i]));
        let (family, trials) = worlds[i];
        let world_seed = trials.first().map_or(Seed(0), |trial| trial.world_seed);
        WorldRanks { family: names[family].to_owned(), world_seed, difficulty, mapping, navigation }
    };
    Some(Ranks {
        worlds: worlds.len(),
        tau: values.each_ref().map(|[one, two]| kendall_tau(one, two)),
        families: by_family.into_iter().map(family).collect(),
        each: (0..worlds.len()).map(world).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::Score1;

    fn record(map: u32, one: f64, two: f64) -> Record {
        let scores = Scores {
            difficulty: two,
            score_1: Score1 { difficulty: one, ..Score1::default() },
            ..Scores::default()
        };
        let world_seed = Seed(40 + u64::from(map));
        Record { map, world_seed, scores: Some(scores), ..Record::default() }
    }

    #[test]
    fn ranks_are_those_of_the_means_and_ties_share_theirs() {
        // Means by score 1: 1, 2, 3; by score 2: 5, 5, 1.
        let records = [
            (0, 0.0, 4.0),
            (0, 2.0, 6.0),
            (1, 2.0, 5.0),
            (1, 2.0, 5.0),
            (2, 3.0, 1.0),
            (2, 3.0, 1.0),
        ]
        .map(|(map, one, two)| record(map, one, two));
        let all: Vec<&Record> = records.iter().collect();
        let worlds = [(0, &all[0..2]), (0, &all[2..4]), (1, &all[4..6])];
        let found = ranks(&["a", "b"], &worlds).expect("three worlds");
        assert_eq!(found.families[0].difficulty, [1.5, 2.5]);
        assert_eq!(found.families[1].difficulty, [3.0, 1.0]);
        let csv = String::from_utf8(found.csv().expect("rows")).expect("text");
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], "family,world_seed,rank_D1,rank_D,rank_M1,rank_M,rank_N1,rank_N");
        assert_eq!(lines[2..], ["a,41,2,2.5,2,2,2,2", "b,42,3,1,2,2,2,2"]);
        // One of three pairs is tied by score 2, the other two are reversed.
        let tau = found.tau[0].expect("an order");
        assert!((tau + 2.0 / 6.0_f64.sqrt()).abs() < 1e-12, "{tau}");
        assert_eq!(found.tau[1], None);
        assert_eq!(ranks(&["a"], &worlds[..1]), None);
        // Families without worlds have no ranks.
        let sparse = [(3, &all[0..2]), (3, &all[2..4]), (1, &all[4..6])];
        let sparse = ranks(&["a", "b", "c", "d"], &sparse).expect("three worlds");
        let ranks_of =
            |i: usize| (sparse.families[i].family.as_str(), sparse.families[i].difficulty);
        assert_eq!(sparse.families.len(), 2);
        assert_eq!([ranks_of(0), ranks_of(1)], [("b", [3.0, 1.0]), ("d", [1.5, 2.5])]);
        let nan = record(3, f64::NAN, 1.0);
        assert_eq!(ranks(&["a", "b"], &[(0, &all[0..2]), (1, &[&nan])]), None);
    }
}
