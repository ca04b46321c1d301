//! The parts of the variance: level, map, and noise.

use serde::Serialize;

use crate::experiment::record::Record;
use crate::score::Scores;

/// Fractions of the variance of a trial, with policies averaged. They add up to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shares {
    /// Variance between levels.
    pub level: f64,
    /// Variance between maps of a level; with one noise seed, that of maps and noise together.
    pub map: f64,
    /// Variance between noise seeds on a map; absent with one noise seed.
    pub noise: Option<f64>,
}

/// Returns the components of a nested analysis of variance (maps within levels, noise within maps),
/// estimated from the mean squares and cut at 0 (Searle and others, Variance Components, 1992, chapter
/// 3). `None` with one map per level, or if nothing varies.
pub fn shares(records: &[&Record], of: fn(&Scores) -> f64) -> Option<Shares> {
    // Means over policies, by level, map and noise.
    let of_noise = |trials: &[&Record]| {
        trials.iter().map(|trial| of(&trial.scores)).sum::<f64>() / trials.len() as f64
    };
    let levels: Vec<Vec<Vec<f64>>> = records
        .chunk_by(|a, b| a.trial.level == b.trial.level)
        .map(|level| {
            let maps = level.chunk_by(|a, b| a.trial.map == b.trial.map);
            let noises = |map: &[&Record]| {
                map.chunk_by(|a, b| a.trial.noise == b.trial.noise).map(of_noise).collect()
            };
            maps.map(noises).collect()
        })
        .collect();
    components(&levels)
}

fn components(levels: &[Vec<Vec<f64>>]) -> Option<Shares> {
    let (m, s) = (levels.first()?.len(), levels.first()?.first()?.len());
    let unbalanced = |maps: &Vec<Vec<f64>>| maps.len() != m || maps.iter().any(|n| n.len() != s);
    if levels.len() < 2 || m < 2 || levels.iter().any(unbalanced) {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let spread = |values: &[f64]| {
        let mean = mean(values);
        values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>()
    };
    let maps: Vec<Vec<f64>> =
        levels.iter().map(|maps| maps.iter().map(|noise| mean(noise)).collect()).collect();
    let means: Vec<f64> = maps.iter().map(|maps| mean(maps)).collect();
    let (l_count, m_count, s_count) = (levels.len() as f64, m as f64, s as f64);
    let of_level = m_count * s_count * spread(&means) / (l_count - 1.0);
    let within: f64 = maps.iter().map(|maps| spread(maps)).sum();
    let of_map = s_count * within / (l_count * (m_count - 1.0));
    let of_noise = (s > 1).then(|| {
        let within: f64 = levels.iter().flatten().map(|noise| spread(noise)).sum();
        within / (l_count * m_count * (s_count - 1.0))
    });
    let level = ((of_level - of_map) / (m_count * s_count)).max(0.0);
    let map = ((of_map - of_noise.unwrap_or(0.0)) / s_count).max(0.0);
    let total = level + map + of_noise.unwrap_or(0.0);
    (total > 0.0).then(|| Shares {
        level: level / total,
        map: map / total,
        noise: of_noise.map(|noise| noise / total),
    })
}

#[cfg(test)]
mod tests {
    use envgen::Seed;
    use envgen::distribution::standard_normal;

    use super::*;

    #[test]
    fn known_components_are_found() {
        // Variances 4 of levels, 1 of maps and 0.25 of noise. Over 400 levels the level's share has
        // a standard error of about 0.02; fixed seed.
        let mut stream = Seed(3).stream("test", 0);
        let mut normal = |deviation: f64| deviation * standard_normal(&mut stream);
        let mut levels = Vec::new();
        for _ in 0..400 {
            let level = normal(2.0);
            let mut maps = Vec::new();
            for _ in 0..6 {
                let map = level + normal(1.0);
                maps.push((0..4).map(|_| map + normal(0.5)).collect());
            }
            levels.push(maps);
        }
        let found = components(&levels).expect("shares");
        assert!((found.level - 4.0 / 5.25).abs() < 0.06, "{found:?}");
        assert!((found.map - 1.0 / 5.25).abs() < 0.05, "{found:?}");
        let sum = found.level + found.map + found.noise.unwrap();
        assert!((sum - 1.0).abs() < 1e-12);
    }

    #[test]
    fn noise_is_no_map() {
        // All maps of a level are equal but for noise of mean 0.
        let maps = |level: f64| vec![vec![level - 1.0, level + 1.0]; 3];
        let found = components(&[maps(0.0), maps(10.0)]).expect("shares");
        assert_eq!(found.map, 0.0);
        assert!(found.level > 0.9);
        assert_eq!(components(&[maps(0.0)]), None);
        assert_eq!(components(&[vec![vec![1.0]; 2], vec![vec![1.0]; 2]]), None);
        let one = components(&[vec![vec![1.0], vec![2.0]], vec![vec![5.0], vec![6.0]]]);
        assert_eq!(one.expect("shares").noise, None);
    }
}
