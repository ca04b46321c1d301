//! Rank correlation.

use statrs::statistics::{Data, OrderStatistics, RankTieBreaker};

use super::measure::MapValues;
use crate::experiment::design::Design;

/// Number of random orders by which chance is estimated.
const SHUFFLES: usize = 10_000;

/// Tolerance, since equal correlations may differ in their last bits.
const NEAR: f64 = 1e-9;

/// Returns Spearman's rank correlation, where ties have their mean rank; `None` for lists of different
/// lengths, or if all values of one list are equal.
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

/// Returns the ranks of values from 1, where ties have their mean rank.
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

/// The null distribution of Spearman's correlation: correlations of levels with the values of a measure
/// in random order.
#[derive(Clone, Debug)]
pub struct Null {
    /// The correlations in ascending order.
    rhos: Vec<f64>,
}

impl Null {
    /// Shuffles measured values, one per map of a design. The draws follow from the design's seed.
    /// Equal values stay equal.
    pub fn new(design: &Design, maps: &[MapValues], measured: &[f64]) -> Self {
        let levels: Vec<f64> = maps.iter().map(|map| design.levels[map.level]).collect();
        let (levels, mut places) = (ranks(&levels), ranks(measured));
        // This makes the draws depend only on which values are equal.
        places.sort_by(f64::total_cmp);
        let mut stream = design.seed.stream("experiment/null", 0);
        let draw = |_| {
            stream.shuffle(&mut places);
            pearson(&levels, &places).unwrap_or(0.0)
        };
        let mut rhos: Vec<f64> = (0..SHUFFLES).map(draw).collect();
        rhos.sort_by(f64::total_cmp);
        Null { rhos }
    }

    /// Returns the critical value: the least correlation that chance reaches in at most 5 % of cases;
    /// `None` if chance reaches even the greatest one more often.
    pub fn critical(&self) -> Option<f64> {
        // This includes the correlation itself, as in `p_value`.
        let allowed = (self.rhos.len() + 1) / 20 - 1;
        let edge = self.rhos[self.rhos.len() - allowed - 1];
        self.rhos.iter().find(|&&rho| rho > edge + NEAR).copied()
    }

    /// Returns the probability that chance gives a correlation of `rho` or more.
    pub fn p_value(&self, rho: f64) -> f64 {
        let below = self.rhos.partition_point(|&other| other < rho - NEAR);
        (self.rhos.len() - below + 1) as f64 / (self.rhos.len() + 1) as f64
    }

    /// Returns the probability that chance gives a correlation of `rho` or less.
    pub fn p_value_below(&self, rho: f64) -> f64 {
        let below = self.rhos.partition_point(|&other| other <= rho + NEAR);
        (below + 1) as f64 / (self.rhos.len() + 1) as f64
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

    /// The null of measurements in pairs of maps, each pair of a higher level than the one before.
    fn null(measured: &[f64]) -> Null {
        let map = |i: usize| MapValues {
            level: i / 2,
            map: i as u32 % 2,
            means: [0.0; MEASURES.len()],
            features: MapFeatures::default(),
        };
        let maps: Vec<MapValues> = (0..measured.len()).map(map).collect();
        Null::new(&Design::default(), &maps, measured)
    }

    #[test]
    fn ten_maps_need_a_correlation_of_a_half() {
        let null = null(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let critical = null.critical().unwrap();
        // Of all 113400 orders of five pairs 4.93 % reach 0.5662 and 5.87 % reach 0.5416, by
        // counting. The seed is fixed.
        assert!((critical - 0.566_220_86).abs() < 1e-6, "{critical}");
        let p = null.p_value(critical);
        assert!(p <= 0.0501 && p > 0.045, "{p}");
        assert!((null.p_value(0.541_602) - 0.0587).abs() < 0.007);
        assert!(null.p_value(-1.0) == 1.0 && null.p_value(1.0) < 1e-3);
        assert!(null.p_value_below(1.0) == 1.0 && null.p_value_below(-1.0) < 1e-3);
    }

    /// Expected shares are by counting; those of 10,000 orders are within 0.02 of them, five standard deviations.
    #[test]
    fn equal_values_stay_equal_by_chance() {
        let levels = |maps: u32| (0..maps).map(|i| f64::from(i / 2)).collect::<Vec<_>>();
        let p = |measured: &[f64]| {
            let rho = spearman(&levels(measured.len() as u32), measured).unwrap();
            null(measured).p_value(rho)
        };
        // Both maps of the higher level are above the others in one of six orders.
        for four in [[1.0, 2.0, 3.0, 4.0], [0.0, 0.0, 3.0, 4.0]] {
            assert!((p(&four) - 1.0 / 6.0).abs() < 0.02, "{}", p(&four));
            assert_eq!(null(&four).critical(), None);
        }
        let reversed = null(&[4.0, 3.0, 2.0, 1.0]).p_value_below(-1.0 + 0.2);
        assert!((reversed - 1.0 / 6.0).abs() < 0.02, "{reversed}");
        // One of ten maps measures something: it is of the highest level in one of five orders.
        let ten = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        assert!((p(&ten) - 0.2).abs() < 0.02, "{}", p(&ten));
    }
}
