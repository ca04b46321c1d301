//! Rank correlation.

use super::measure::MapValues;
use crate::experiment::design::Design;

/// Number of random orders by which chance is estimated.
const SHUFFLES: usize = 10_000;

/// Tolerance, since equal correlations may differ in their last bits.
const NEAR: f64 = 1e-9;

/// Returns Spearman's rank correlation, where ties have their mean rank; `None` for lists of different
/// lengths, if all values of one list are equal, or if one is NaN.
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
    pearson(&ranks(a)?, &ranks(b)?)
}

/// Returns the ranks of values from 1, where ties have their mean rank; `None` if a value is NaN.
pub(crate) fn ranks(values: &[f64]) -> Option<Vec<f64>> {
    if values.iter().any(|value| value.is_nan()) {
        return None;
    }
    // Adding 0 makes -0 the 0 that it is equal to.
    let at = |i: usize| values[i] + 0.0;
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| at(i).total_cmp(&at(j)));
    let (mut ranks, mut before) = (vec![0.0; values.len()], 0);
    for ties in order.chunk_by(|&i, &j| at(i) == at(j)) {
        let rank = before as f64 + 0.5 * (ties.len() + 1) as f64;
        ties.iter().for_each(|&i| ranks[i] = rank);
        before += ties.len();
    }
    Some(ranks)
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
    /// The correlations in ascending order; none if what was measured has no ranks.
    rhos: Vec<f64>,
}

impl Null {
    /// Shuffles measured values, one per map of a design. The draws follow from the design's seed.
    /// Equal values stay equal. Of values of which one is NaN nothing is rare by chance: there is no
    /// critical value, and all probabilities are 1.
    pub fn new(design: &Design, maps: &[MapValues], measured: &[f64]) -> Self {
        let levels: Vec<f64> = maps.iter().map(|map| design.levels[map.level]).collect();
        let Some((levels, mut places)) = ranks(&levels).zip(ranks(measured)) else {
            return Null { rhos: Vec::new() };
        };
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
        let allowed = ((self.rhos.len() + 1) / 20).checked_sub(1)?;
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
    use proptest::prelude::*;

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

    /// Ranks by counting the values below and the equal ones.
    fn counted(values: &[f64]) -> Vec<f64> {
        let rank = |own: &f64| {
            let below = values.iter().filter(|other| *other < own).count();
            let equal = values.iter().filter(|other| *other == own).count();
            below as f64 + 0.5 * (equal as f64 + 1.0)
        };
        values.iter().map(rank).collect()
    }

    /// Numbers with many ties, and now and then infinite ones and NaN.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            6 => (-3..3_i32).prop_map(f64::from),
            2 => any::<f64>(),
            1 => prop::sample::select(vec![-0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]),
        ]
    }

    proptest! {
        #[test]
        fn any_numbers_have_a_correlation_or_none(
            a in prop::collection::vec(number(), 0..12), b in prop::collection::vec(number(), 0..12),
            equal: bool,
        ) {
            let b = if equal { a.iter().rev().copied().collect() } else { b };
            let is_nan = |values: &[f64]| values.iter().any(|value| value.is_nan());
            for values in [&a, &b] {
                prop_assert_eq!(ranks(values), (!is_nan(values)).then(|| counted(values)));
            }
            let found = spearman(&a, &b);
            if a.len() != b.len() || is_nan(&a) || is_nan(&b) {
                prop_assert_eq!(found, None);
            } else {
                prop_assert_eq!(found, pearson(&counted(&a), &counted(&b)));
                prop_assert!(found.is_none_or(|rho| (-1.0..=1.0).contains(&rho)));
            }
        }
    }

    #[test]
    fn what_has_no_ranks_is_never_rare_by_chance() {
        assert_eq!(spearman(&[1.0, f64::NAN, 3.0], &[1.0, 2.0, 3.0]), None);
        assert_eq!(spearman(&[f64::INFINITY; 2], &[1.0, 2.0]), None);
        let null = null(&[1.0, 2.0, f64::NAN, 4.0]);
        assert_eq!(null.critical(), None);
        assert_eq!((null.p_value(1.0), null.p_value_below(-1.0)), (1.0, 1.0));
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
