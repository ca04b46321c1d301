//! How far the pose of a robot drifts that corrects its odometry by its scans.

use super::feature::features;
use super::platform::Platform;
use super::tour::Stop;

/// How much of a scan's information a scan matcher uses: fitted once to mapping trials.
const USED: f64 = 0.02;

features! {
    /// Drift along the tour: at each scan odometry adds the variance `q = k_ss ds + k_st |dth|`, of which
    /// the scan leaves `u = 1 / (1/q + 0.02 l2 / sigma^2)`, with l2 of the scan's information; the heading
    /// likewise with `k_tt |dth| + k_ts ds` and the information on the heading.
    pub struct Drift {
        /// Root of the sum of all u: the standard deviation of the position that the worst directions of
        /// the scans leave.
        drift_position_m: f64, "m";
        /// Standard deviation of the heading at the tour's end.
        drift_heading_rad: f64, "rad";
        /// Root mean square over the scans of the position's deviation, with that of the heading times
        /// the distance from the start.
        drift_map_m: f64, "m";
        /// `drift_position_m` per root of the tour's length: without echo it is the root of `k_ss` and of
        /// what turning adds.
        drift_rate_m_per_root_m: Option<f64>, "m/m^0.5";
    }
}

impl Drift {
    pub(super) fn of(stops: &[Stop], platform: &Platform) -> Self {
        let trust = USED / (platform.sigma * platform.sigma);
        let (mut position, mut heading, mut map, mut length) = (0.0, 0.0, 0.0, 0.0);
        for stop in stops {
            let (ds, turn) = (stop.distance, stop.turning);
            position +=
                left(platform.k_ss * ds + platform.k_st * turn, trust * stop.information.least);
            heading +=
                left(platform.k_tt * turn + platform.k_ts * ds, trust * stop.information.heading);
            map += position + heading * stop.position.distance_squared(stops[0].position);
            length += ds;
        }
        Drift {
            drift_position_m: f64::sqrt(position),
            drift_heading_rad: f64::sqrt(heading),
            drift_map_m: f64::sqrt(map / stops.len().max(1) as f64),
            drift_rate_m_per_root_m: (length > 0.0).then(|| f64::sqrt(position / length)),
        }
    }
}

/// The variance that a measurement of some information leaves.
fn left(variance: f64, information: f64) -> f64 {
    variance / (1.0 + variance * information)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::information::ScanInformation;
    use super::*;

    fn straight(information: ScanInformation) -> Vec<Stop> {
        let stop = |i: i32| Stop {
            position: DVec2::new(0.5 * f64::from(i), 0.0),
            distance: if i == 0 { 0.0 } else { 0.5 },
            turning: if i == 0 { 0.0 } else { 0.1 },
            information,
            seen: 0,
        };
        (0..=40).map(stop).collect()
    }

    #[test]
    fn without_echo_errors_are_those_of_the_odometry() {
        let platform = Platform::default();
        let drift = Drift::of(&straight(ScanInformation::default()), &platform);
        let position = 20.0 * platform.k_ss + 4.0 * platform.k_st;
        let heading = 20.0 * platform.k_ts + 4.0 * platform.k_tt;
        assert!((drift.drift_position_m - position.sqrt()).abs() < 1e-12);
        assert!((drift.drift_heading_rad - heading.sqrt()).abs() < 1e-12);
        let rate = drift.drift_rate_m_per_root_m.expect("it drove");
        assert!((rate - (position / 20.0).sqrt()).abs() < 1e-12);
        // Variances grow with i, those of the heading count by i^2: sums of i and of i^3.
        let (n, all) = (41.0, 40.0);
        let mean = position / all * (all * (all + 1.0) / 2.0) / n
            + heading / all * 0.25 * (all * (all + 1.0) / 2.0) * (all * (all + 1.0) / 2.0) / n;
        assert!((drift.drift_map_m - mean.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_a_scan_tells_well_is_as_good_as_the_scan() {
        let information = ScanInformation { greatest: 1e12, least: 1e12, heading: 1e12 };
        let platform = Platform::default();
        let drift = Drift::of(&straight(information), &platform);
        // 40 scans, each leaving sigma^2 / (0.02 l2).
        let expected = (40.0 * 1e-4 / (0.02 * 1e12_f64)).sqrt();
        assert!((drift.drift_position_m / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_robot_that_stays_does_not_drift() {
        let drift = Drift::of(&straight(ScanInformation::default())[..1], &Platform::default());
        assert_eq!(drift.drift_position_m, 0.0);
        assert_eq!(drift.drift_rate_m_per_root_m, None);
    }
}
