//! Intervals of components of the variance by the jackknife over maps.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::factorial::{cut, within};
use super::resample::Interval;

/// Variances of all components and of the same without each map, none of them cut at 0.
pub(super) struct Intervals<'a> {
    pub(super) found: &'a [f64],
    /// Empty if there are too few maps.
    pub(super) without_each: &'a [Vec<f64>],
    /// The greatest variance that rounding leaves.
    pub(super) least: f64,
}

impl Intervals<'_> {
    /// The fraction of a component of which each level has a number of trials.
    pub(super) fn share(&self, component: usize, trials: f64) -> Interval {
        let all = |variances: &[f64]| variances.iter().copied().map(cut).sum::<f64>();
        let value = cut(self.found[component]) / all(self.found);
        if self.without_each.is_empty() {
            return Interval { value, low: 0.0, high: 1.0 };
        }
        let (low, high) = if component == self.found.len() - 1 {
            let share = |variances: &[f64]| {
                libm::log(variances[component].max(self.least) / all(variances).max(self.least))
            };
            let (low, high) = self.jackknife(share);
            (libm::exp(low), libm::exp(high.min(0.0)))
        } else {
            let rest = |variances: &[f64]| all(variances) - cut(variances[component]);
            let (low, high) = self.ratio(component, trials, rest);
            // A ratio of 0 divides by infinity.
            (1.0 / (1.0 + 1.0 / low), 1.0 / (1.0 + 1.0 / high))
        };
        Interval { value, low: low.min(value), high: high.max(value) }
    }

    /// The variance of maps, each with a number of trials, over that within a map.
    pub(super) fn signal_to_noise(&self, trials: f64) -> Option<Interval> {
        let varies = |variances: &[f64]| within(variances) > self.least;
        let are_known = !self.without_each.is_empty()
            && varies(self.found)
            && self.without_each.iter().all(|variances| varies(variances));
        if !are_known {
            return None;
        }
        let value = cut(self.found[0]) / within(self.found);
        let (low, high) = self.ratio(0, trials, within);
        high.is_finite().then(|| Interval { value, low: low.min(value), high: high.max(value) })
    }

    /// The interval of the ratio of a variance to the rest. Its logarithm would be lost where it is near 0: this takes
    /// the logarithm of 1 + `trials` times the ratio, as of the ratio of mean squares.
    fn ratio(&self, component: usize, trials: f64, rest: impl Fn(&[f64]) -> f64) -> (f64, f64) {
        let logarithm = |variances: &[f64]| {
            let ratio = variances[component] / rest(variances).max(self.least);
            // Variances far below 0 say nothing, but would widen the interval.
            libm::log((1.0 + trials * ratio).max(0.5))
        };
        let (low, high) = self.jackknife(logarithm);
        let ratio = |logarithm: f64| cut(libm::expm1(logarithm) / trials);
        (ratio(low), ratio(high))
    }

    fn jackknife(&self, of: impl Fn(&[f64]) -> f64) -> (f64, f64) {
        let without_each: Vec<f64> = self.without_each.iter().map(|one| of(one)).collect();
        jackknife(of(self.found), &without_each)
    }
}

/// Returns the ends of a 95 % interval around an estimate, given the estimates without each of at least two maps:
/// their spread gives the standard error. The error of the estimate should be about normal, as for logarithms of
/// variances (Arvesen and Schmitz, Robust procedures for variance component problems using the jackknife, Biometrics
/// 26, 1970).
fn jackknife(estimate: f64, without_each: &[f64]) -> (f64, f64) {
    let maps = without_each.len() as f64;
    let mean = without_each.iter().sum::<f64>() / maps;
    let squares: f64 = without_each.iter().map(|value| (value - mean) * (value - mean)).sum();
    let error = ((maps - 1.0) / maps * squares).sqrt();
    // There is at least one degree of freedom.
    let t = StudentsT::new(0.0, 1.0, maps - 1.0).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
    (estimate - t * error, estimate + t * error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_mean_is_by_student() {
        let values = [1.0, 2.5, 2.0, 4.0, 3.0];
        let sum: f64 = values.iter().sum();
        let (low, high) = jackknife(sum / 5.0, &values.map(|value| (sum - value) / 4.0));
        // The standard error of the mean is 0.5, and t with four degrees of freedom 2.776.
        assert!((low - (2.5 - 1.3882)).abs() < 1e-4 && (high - (2.5 + 1.3882)).abs() < 1e-4);
    }
}
