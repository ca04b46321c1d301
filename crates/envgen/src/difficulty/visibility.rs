//! Features of visibility: how much a robot sees, and how similar its scans are.

use super::feature::features;
use super::platform::Platform;
use super::poses::View;
use super::statistics::{mean, quantile};

/// The distance in metres beyond which two poses are different places.
const APART: f64 = 5.0;

/// The difference of ranges below which scans are similar, in metres (root mean square).
const ALIKE: f64 = 0.2;

features! {
    /// Features of what the laser sees from the poses.
    pub struct Visibility {
        /// Mean area that a scan sees.
        visible_area_mean_m2: f64, "m^2";
        /// 10 % quantile of the area that a scan sees.
        visible_area_10_m2: f64, "m^2";
        /// Mean area that a scan sees per area of free ground.
        visible_share_mean: f64, "";
        /// Share of beams with an echo.
        echo_share: f64, "";
        /// Share of beams that are lost, since they end at parts that are too dark to be seen from there.
        lost_beam_share: f64, "";
        /// Mean range of the echoes; none without echo.
        echo_range_mean_m: Option<f64>, "m";
        /// Free ground by the square of the greatest range: how many scans' worth of ground there is.
        ground_over_range_squared: f64, "";
        /// Share of the pairs of poses over 5 m apart whose scans differ by under 0.2 m (root mean
        /// square); beams without echo count as the greatest range, and beams that either scan has lost do
        /// not count. None where no poses are that far apart.
        alias_share: Option<f64>, "";
    }
}

impl Visibility {
    pub(super) fn of(views: &[View], platform: &Platform, ground_area: f64) -> Self {
        let step = platform.beam_step();
        let mut areas: Vec<f64> = views.iter().map(|view| swept_area(&view.ranges, step)).collect();
        areas.sort_by(f64::total_cmp);
        let beams: usize = views.iter().map(|view| view.ranges.len()).sum();
        let echoes: usize = views.iter().map(|view| view.echoes).sum();
        let lost: usize = views.iter().map(|view| view.lost).sum();
        let echo_ranges: f64 = views.iter().map(|view| view.echo_ranges).sum();
        let area = mean(&areas);
        Visibility {
            visible_area_mean_m2: area,
            visible_area_10_m2: quantile(&areas, 0.1),
            visible_share_mean: area / ground_area,
            echo_share: echoes as f64 / beams.max(1) as f64,
            lost_beam_share: lost as f64 / beams.max(1) as f64,
            echo_range_mean_m: (echoes > 0).then(|| echo_ranges / echoes as f64),
            ground_over_range_squared: ground_area / (platform.max_range * platform.max_range),
            alias_share: alias_share(views),
        }
    }
}

/// Returns the area in square metres under the ranges of beams `step` radians apart: a sector for each beam, half a
/// sector for the first and the last beam, and nothing for a lost beam.
fn swept_area(ranges: &[f64], step: f64) -> f64 {
    let square = |range: &f64| if range.is_nan() { 0.0 } else { range * range };
    let end = |range: Option<&f64>| range.map_or(0.0, square);
    let all: f64 = ranges.iter().map(square).sum();
    0.5 * step * (all - 0.5 * (end(ranges.first()) + end(ranges.last())))
}

fn alias_share(views: &[View]) -> Option<f64> {
    let (mut pairs, mut alike) = (0_u64, 0_u64);
    for (i, a) in views.iter().enumerate() {
        for b in &views[i + 1..] {
            if a.position.distance_squared(b.position) > APART * APART {
                pairs += 1;
                alike += u64::from(are_alike(a, b));
            }
        }
    }
    (pairs > 0).then(|| alike as f64 / pairs as f64)
}

fn are_alike(a: &View, b: &View) -> bool {
    let pairs = || a.ranges.iter().zip(&b.ranges);
    let shared = match a.lost + b.lost {
        0 => a.ranges.len(),
        _ => pairs().filter(|(a, b)| !a.is_nan() && !b.is_nan()).count(),
    };
    let most = ALIKE * ALIKE * shared as f64;
    let square = |(a, b): (&f64, &f64)| {
        let difference = a - b;
        if difference.is_nan() { 0.0 } else { difference * difference }
    };
    let mut sum = 0.0;
    // Most pairs differ at once; without a beam in common nothing tells them apart.
    shared == 0
        || a.ranges.chunks(16).zip(b.ranges.chunks(16)).all(|(a, b)| {
            sum += a.iter().zip(b).map(square).sum::<f64>();
            sum < most
        })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec2;

    use super::super::information::ScanInformation;
    use super::*;

    fn view(x: f64, ranges: Vec<f64>) -> View {
        let position = DVec2::new(x, 0.0);
        let lost = ranges.iter().filter(|range| range.is_nan()).count();
        let (echoes, echo_ranges) = (ranges.len() - lost, 0.0);
        let information = ScanInformation::default();
        View { position, information, ranges, echoes, echo_ranges, lost }
    }

    #[test]
    fn an_open_half_turn_is_half_a_disc() {
        assert!((swept_area(&[2.0; 181], PI / 180.0) - 2.0 * PI).abs() < 1e-12);
        assert_eq!(swept_area(&[], 1.0), 0.0);
        // Of five beams half a sector and two whole ones are left.
        let dark = [2.0, f64::NAN, 2.0, 2.0, f64::NAN];
        assert!((swept_area(&dark, 0.1) - 2.5 * 0.1 * 2.0).abs() < 1e-12);
    }

    #[test]
    fn alike_scans_far_apart_are_aliases() {
        let views = [
            view(0.0, vec![1.0; 30]),
            view(3.0, vec![1.0; 30]),
            view(9.0, vec![1.1; 30]),
            view(20.0, vec![1.4; 30]),
        ];
        // Far pairs: 0-2, 0-3, 1-2, 1-3, 2-3, of which 0-2 and 1-2 differ by 0.1 m.
        assert_eq!(alias_share(&views), Some(0.4));
        assert_eq!(alias_share(&views[..2]), None);
    }

    #[test]
    fn lost_beams_tell_no_places_apart() {
        let dark = |n: usize| [vec![f64::NAN; n], vec![1.0; 30 - n]].concat();
        let far = [vec![3.0; 5], vec![1.0; 25]].concat();
        assert!(!are_alike(&view(0.0, far.clone()), &view(9.0, dark(0))));
        assert!(!are_alike(&view(0.0, far.clone()), &view(9.0, dark(4))));
        assert!(are_alike(&view(0.0, far.clone()), &view(9.0, dark(5))));
        assert!(are_alike(&view(0.0, far), &view(9.0, dark(30))));
    }
}
