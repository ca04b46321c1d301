//! Whether a measure follows the level of difficulty.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::measure::{MEASURES, MapValues, Measure};
use super::rank::{Null, spearman};
use super::resample::{Interval, bootstrap};
use super::variance::{Shares, shares};
use crate::experiment::design::Design;
use crate::experiment::record::Record;
use crate::score::kendall_tau;

/// Greatest probability that counts as rare.
const SELDOM: f64 = 0.05;

/// How a measure follows the level.
#[derive(Clone, Debug, Serialize)]
pub struct Order {
    /// Symbol of the measure.
    pub measure: &'static str,
    /// Spearman's rank correlation between level and map means.
    pub rho: Option<Interval>,
    /// Probability that chance alone gives this correlation or a greater one.
    pub p: Option<f64>,
    /// Probability that chance alone gives this correlation or a smaller one.
    pub p_below: Option<f64>,
    /// Kendall's tau-b between level and map means.
    pub tau: Option<f64>,
    /// Mean of the maps of each level.
    pub means: Vec<Mean>,
    /// Number of pairs of neighbouring levels of which the higher has the higher mean.
    pub neighbours_in_order: usize,
    /// Parts of the variance of single trials, with policies averaged.
    pub shares: Option<Shares>,
}

/// The verdict on an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The correlation is positive beyond its interval and beyond chance, and the mean of every level
    /// is above that of the level before.
    InOrder,
    /// The correlation is positive beyond both, but the means of some neighbouring levels are not in
    /// order.
    OnTheWhole,
    /// The interval of the correlation contains 0, chance gives as much, or there is no correlation.
    NotShown,
    /// The correlation is negative beyond its interval and beyond chance.
    Reversed,
}

/// The mean of the maps of a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// The level.
    pub level: f64,
    /// Number of maps.
    pub maps: usize,
    /// The mean, with Student's 95 % interval.
    pub mean: Interval,
}

impl Order {
    /// Returns the number of pairs of neighbouring levels.
    pub fn neighbours(&self) -> usize {
        self.means.len().saturating_sub(1)
    }

    /// Returns whether chance gives the correlation in less than one of twenty cases.
    pub fn counts(&self) -> bool {
        self.p.is_some_and(|p| p <= SELDOM)
    }

    /// Returns the verdict on the order. Since the bootstrap's interval is too narrow for few maps per
    /// level, the correlation must also be rare by chance.
    pub fn verdict(&self) -> Verdict {
        let (Some(rho), Some(p_below)) = (self.rho, self.p_below) else { return Verdict::NotShown };
        if rho.is_negative() && p_below <= SELDOM {
            Verdict::Reversed
        } else if !rho.is_positive() || !self.counts() {
            Verdict::NotShown
        } else if self.neighbours_in_order == self.neighbours() {
            Verdict::InOrder
        } else {
            Verdict::OnTheWhole
        }
    }
}

/// Computes how a measure follows the level.
pub fn order(
    design: &Design,
    measure: &Measure,
    records: &[&Record],
    values: &[MapValues],
) -> Order {
    let place = MEASURES.iter().position(|m| m.symbol == measure.symbol).unwrap_or(0);
    let of = |i: usize| values[i].means[place];
    let groups: Vec<usize> = values.iter().map(|map| map.level).collect();
    let level = |i: usize| design.levels[groups[i]];
    let mut stream = design.seed.stream("experiment/order", place as u64);
    let [rho] = bootstrap(&groups, &mut stream, |drawn| {
        let levels: Vec<f64> = drawn.iter().map(|&i| level(i)).collect();
        let found: Vec<f64> = drawn.iter().map(|&i| of(i)).collect();
        [spearman(&levels, &found)]
    });
    let all = || 0..values.len();
    let levels: Vec<f64> = all().map(level).collect();
    let means: Vec<Mean> = (0..design.levels.len())
        .map(|group| {
            let own: Vec<f64> = all().filter(|&i| groups[i] == group).map(of).collect();
            let (level, maps) = (design.levels[group], own.len());
            Mean { level, maps, mean: mean(&own, measure.most) }
        })
        .collect();
    let measured: Vec<f64> = all().map(of).collect();
    let null = Null::new(design, values, &measured);
    Order {
        measure: measure.symbol,
        p: rho.map(|rho| null.p_value(rho.value)),
        p_below: rho.map(|rho| null.p_value_below(rho.value)),
        rho,
        tau: kendall_tau(&levels, &measured),
        neighbours_in_order: means
            .windows(2)
            .filter(|pair| pair[1].mean.value > pair[0].mean.value)
            .count(),
        means,
        shares: shares(records, measure.of),
    }
}

/// Mean with Student's 95 % interval, cut to the range of the measure.
fn mean(values: &[f64], most: f64) -> Interval {
    let (value, half) = mean_and_half(values);
    Interval { value, low: (value - half).max(0.0), high: (value + half).min(most) }
}

/// Mean, and half of Student's 95 % interval.
pub(crate) fn mean_and_half(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|x| (x - value) * (x - value)).sum();
    let error = (squares / (count - 1.0) / count).sqrt();
    (value, half_interval(error, count - 1.0))
}

/// Half of Student's 95 % interval for a standard error with some degrees of freedom. It is infinite
/// without any, since anything is possible then.
pub(crate) fn half_interval(standard_error: f64, degrees: f64) -> f64 {
    match StudentsT::new(0.0, 1.0, degrees) {
        Ok(law) => law.inverse_cdf(0.975) * standard_error,
        Err(_) => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_with_its_interval_by_hand() {
        // Deviation 1, standard error 1 / sqrt 3, t(2, 97.5 %) = 4.302653.
        let found = mean(&[4.0, 5.0, 6.0], 10.0);
        let half = 4.302_652_73 / 3.0_f64.sqrt();
        assert_eq!(found.value, 5.0);
        assert!((found.high - 5.0 - half).abs() < 1e-6, "{found:?}");
        assert!((5.0 - found.low - half).abs() < 1e-6, "{found:?}");
        let two = mean(&[1.0, 9.0], 10.0);
        assert_eq!((two.low, two.high), (0.0, 10.0));
        assert_eq!(mean(&[3.0], 10.0), Interval { value: 3.0, low: 0.0, high: 10.0 });
    }
}
