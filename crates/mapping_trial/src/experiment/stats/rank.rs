//! Correlation of ranks.

use statrs::statistics::{Data, OrderStatistics, RankTieBreaker};

use super::measure::MapValues;
use crate::experiment::design::Design;

/// Number of random orders that show what chance gives.
const SHUFFLES: usize = 10_000;

/// Spearman's rank correlation, ties with their mean rank; `None` for lists of different lengths,
/// or when all values of one are equal.
///
/// ```
/// use mapping_trial::experiment::stats::spearman;
///
/// let levels = [1.0, 3.0, 5.0];
/// assert_eq!(spearman(&levels, &[0.1, 0.2, 0.9]), Some(1.0));
/// assert_eq!(spearman(&levels, &[0.1, 0.9, 0.2]), Some(0.5));
/// assert_eq!(spearman(&levels, &[0.5, 0.5, 0.5]), None);
/// ```
pub fn spearman(a: &[f64], b: &[f64]) -> Option<f64> {
    pearson(&ranks(a), &ranks(b))
}

/// The ranks of values from 1, ties with their mean rank.
pub(crate) fn ranks(values: &[f64]) -> Vec<f64> {
    Data::new(values.to_vec()).ranks(RankTieBreaker::Average)
}

/// Pearson's correlation.
pub(crate) fn pearson(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (a_mean, b_mean) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - a_mean, b - b_mean);
        ab += a * b;
        aa += a * a;
        bb += b * b;
    }
    let norm = (aa * bb).sqrt();
    (norm > 0.0).then(|| (ab / norm).clamp(-1.0, 1.0))
}

/// Spearman's correlations of levels with random orders of as many maps: what chance alone gives.
#[derive(Clone, Debug)]
pub struct Null {
    /// In increasing order.
    rhos: Vec<f64>,
}

impl Null {
    /// Shuffles the maps of a design; the draws follow from the design's seed.
    pub fn new(design: &Design, values: &[MapValues]) -> Self {
        let levels: Vec<f64> = values.iter().map(|map| design.levels[map.level]).collect();
        let ranks = Data::new(levels).ranks(RankTieBreaker::Average);
        let mut places: Vec<f64> = (0..ranks.len()).map(|place| place as f64).collect();
        let mut stream = design.seed.stream("experiment/null", 0);
        let draw = |_| {
            stream.shuffle(&mut places);
            pearson(&ranks, &places).unwrap_or(0.0)
        };
        let mut rhos: Vec<f64> = (0..SHUFFLES).map(draw).collect();
        rhos.sort_by(f64::total_cmp);
        Null { rhos }
    }

    /// The least correlation that chance reaches in at most 5 % of cases.
    pub fn critical(&self) -> f64 {
        // Equal correlations may differ in their last bits.
        let near = 1e-9;
        let allowed = self.rhos.len() / 20;
        let edge = self.rhos[self.rhos.len() - allowed - 1];
        let above = self.rhos.iter().find(|&&rho| rho > edge + near);
        above.copied().unwrap_or(edge)
    }

    /// Probability that chance gives a correlation of `rho` or more.
    pub fn p_value(&self, rho: f64) -> f64 {
        let below = self.rhos.partition_point(|&other| other < rho - 1e-9);
        (self.rhos.len() - below + 1) as f64 / (self.rhos.len() + 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::MEASURES;
    use super::*;
    use crate::experiment::record::MapFeatures;

    #[test]
    fn spearman_by_hand() {
        assert_eq!(spearman(&[1.0, 2.0, 3.0, 9.0], &[0.1, 0.2, 0.5, 0.9]), Some(1.0));
        assert_eq!(spearman(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
        // 1 - 6 sum d^2 / (n (n^2 - 1)) = 1 - 6 * 8 / 120.
        let rho = spearman(&[1.0, 2.0, 3.0, 4.0, 5.0], &[2.0, 1.0, 5.0, 4.0, 3.0]).unwrap();
        assert!((rho - (1.0 - 6.0 * 10.0 / 120.0)).abs() < 1e-12, "{rho}");
        // Ties: ranks 1.5, 1.5, 3.5, 3.5 against 1, 2, 3, 4.
        let rho = spearman(&[1.0, 1.0, 3.0, 3.0], &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((rho - 4.0 / 20.0_f64.sqrt()).abs() < 1e-12, "{rho}");
        assert_eq!(spearman(&[1.0, 1.0], &[1.0, 2.0]), None);
        assert_eq!(spearman(&[], &[]), None);
        assert_eq!(spearman(&[1.0], &[1.0, 2.0]), None);
    }

    #[test]
    fn ten_maps_need_a_correlation_of_a_half() {
        let map = |i: usize| MapValues {
            level: i / 2,
            map: i as u32 % 2,
            means: [0.0; MEASURES.len()],
            features: MapFeatures::default(),
        };
        let null = Null::new(&Design::default(), &(0..10).map(map).collect::<Vec<_>>());
        let critical = null.critical();
        // Of all 113400 orders of five pairs 4.93 % reach 0.5662 and 5.87 % reach 0.5416, by
        // counting. The seed is fixed.
        assert!((critical - 0.566_220_86).abs() < 1e-6, "{critical}");
        let p = null.p_value(critical);
        assert!(p <= 0.0501 && p > 0.045, "{p}");
        assert!((null.p_value(0.541_602) - 0.0587).abs() < 0.007);
        assert!(null.p_value(-1.0) == 1.0 && null.p_value(1.0) < 1e-3);
    }
}
