//! The measures, and their means over the trials on a map.

use crate::experiment::record::{MapFeatures, Record};
use crate::score::{Parts, Scores};

/// A measure: a number per trial. A greater value is more difficult.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// Symbol in formulas and tables.
    pub symbol: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Greatest possible value.
    pub most: f64,
    /// Function that returns the value for a trial's scores.
    pub of: fn(&Scores) -> f64,
}

/// All measures: D, M and N, then their parts; D, M and N by score 1, then the parts that differ.
pub const MEASURES: [Measure; 18] = [
    Measure { symbol: "D", name: "difficulty", most: 10.0, of: |s| s.difficulty },
    Measure { symbol: "M", name: "difficulty of mapping", most: 10.0, of: |s| s.mapping },
    Measure { symbol: "N", name: "difficulty of navigation", most: 10.0, of: |s| s.navigation },
    Measure { symbol: "e_wall", name: "walls wrong or missing", most: 1.0, of: |s| s.e_wall },
    Measure { symbol: "e_use", name: "paths that fail on the map", most: 1.0, of: |s| s.e_use },
    Measure { symbol: "e_pose", name: "drift of the pose", most: 1.0, of: |s| s.e_pose },
    Measure { symbol: "e_cov", name: "ground not covered", most: 1.0, of: |s| s.e_cov },
    Measure { symbol: "e_time", name: "time by area", most: 1.0, of: |s| s.e_time },
    Measure { symbol: "e_hit", name: "collisions by distance", most: 1.0, of: |s| s.e_hit },
    Measure { symbol: "e_turn", name: "turning by distance", most: 1.0, of: |s| s.e_turn },
    Measure { symbol: "D1", name: "difficulty", most: 10.0, of: |s| s.score_1.difficulty },
    Measure { symbol: "M1", name: "difficulty of mapping", most: 10.0, of: |s| s.score_1.mapping },
    Measure {
        symbol: "N1",
        name: "difficulty of navigation",
        most: 10.0,
        of: |s| s.score_1.navigation,
    },
    Measure { symbol: "e_use1", name: "paths that fail", most: 1.0, of: |s| s.score_1.e_use },
    Measure {
        symbol: "e_pose1",
        name: "error of the trajectory",
        most: 1.0,
        of: |s| s.score_1.e_pose,
    },
    Measure { symbol: "e_time1", name: "time taken", most: 1.0, of: |s| s.score_1.e_time },
    Measure {
        symbol: "e_hit1",
        name: "collisions and being stuck",
        most: 1.0,
        of: |s| s.score_1.e_hit,
    },
    Measure { symbol: "e_turn1", name: "turning", most: 1.0, of: |s| s.score_1.e_turn },
];

/// The means of the measures on a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapValues {
    /// Index of the map's level in the design.
    pub level: usize,
    /// Number of the map within the level.
    pub map: u32,
    /// Mean of each of [`MEASURES`] over all trials on the map.
    pub means: [f64; MEASURES.len()],
    /// Features of the map.
    pub features: MapFeatures,
}

impl MapValues {
    /// Returns the parts of D, as means over the trials.
    pub fn parts(&self) -> Parts {
        let [_, _, _, e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn, ..] = self.means;
        Parts { e_wall, e_use, e_pose, e_cov, e_time, e_hit, e_turn }
    }
}

/// Returns the means of every map. The records are in the design's order, with those of a map together.
pub fn map_values(records: &[&Record]) -> Vec<MapValues> {
    let maps =
        records.chunk_by(|a, b| (a.trial.level, a.trial.map) == (b.trial.level, b.trial.map));
    let mean = |trials: &[&Record], of: fn(&Scores) -> f64| {
        trials.iter().map(|trial| of(&trial.scores)).sum::<f64>() / trials.len() as f64
    };
    maps.map(|trials| MapValues {
        level: trials[0].trial.level as usize,
        map: trials[0].trial.map,
        means: MEASURES.map(|measure| mean(trials, measure.of)),
        features: trials[0].features.clone(),
    })
    .collect()
}
