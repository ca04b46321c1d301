//! Features of localization: how well scans determine the robot's position.

use super::feature::features;
use super::poses::View;
use super::statistics::{mean, quantile};

/// The ratio of the eigenvalues below which a pose counts as degenerate.
const DEGENERATE: f64 = 0.05;

features! {
    /// Features of how well scans determine the robot's position: A. Censi, On achievable accuracy for range-finder
    /// localization, ICRA 2007, doi:10.1109/ROBOT.2007.364120.
    pub struct Localization {
        /// Translation degeneracy: 1 less the mean of l2/l1, 0 for scans that fix both directions
        /// equally, 1 for scans that slide along walls. A pose without echo counts 1.
        scan_degeneracy: f64, "";
        /// Share of poses with l2/l1 under 0.05, those without echo included.
        scan_degenerate_share: f64, "";
        /// 20 % quantile of l2/l1.
        scan_ratio_20: f64, "";
        /// 20 % quantile of the least standard deviation of the position along its worst direction,
        /// `sigma / sqrt(l2)` (so that 20 % of the poses are better); none where that scan does not fix it.
        scan_position_error_20_m: Option<f64>, "m";
        /// 80 % quantile of the same; none where that scan does not fix it.
        scan_position_error_80_m: Option<f64>, "m";
    }
}

impl Localization {
    pub(super) fn of(views: &[View], sigma: f64) -> Self {
        let mut ratios: Vec<f64> = views.iter().map(|view| view.information.ratio()).collect();
        ratios.sort_by(f64::total_cmp);
        let degenerate = ratios.iter().filter(|&&ratio| ratio < DEGENERATE).count();
        let mut least: Vec<f64> = views.iter().map(|view| view.information.least).collect();
        least.sort_by(f64::total_cmp);
        let error = |share| {
            let least = quantile(&least, share);
            (least > 0.0).then(|| sigma / least.sqrt())
        };
        Localization {
            scan_degeneracy: 1.0 - mean(&ratios),
            scan_degenerate_share: degenerate as f64 / ratios.len().max(1) as f64,
            scan_ratio_20: quantile(&ratios, 0.2),
            scan_position_error_20_m: error(0.8),
            scan_position_error_80_m: error(0.2),
        }
    }
}
