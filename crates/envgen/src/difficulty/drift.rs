//! Features of drift: the pose error of a robot that corrects its odometry by its scans.

use super::feature::features;
use super::platform::Platform;
use super::tour::Stop;

/// The share of a scan's information that a scan matcher uses, fitted once to mapping trials.
const USED: f64 = 0.02;

/// The least l2 of a scan that holds the position well: the number of echoes whose walls are square to its worst
/// direction. With a sigma of 0.01 m it leaves a standard deviation of 0.022 m.
const WELL_HELD: f64 = 10.0;

features! {
    /// Features of the drift along the tour. At each scan, odometry adds the variance
    /// `q = f k_ss ds + f k_st |dth| + (b ds)^2`, of which the scan leaves `u = 1 / (1/q + 0.02 l2 / sigma^2)`,
    /// with l2 of the scan's information. The heading is treated likewise with `f k_tt |dth| + f k_ts ds` and the
    /// information on the heading. Here f is the ground's factor on the variances of odometry, and b the fraction
    /// by which wheels measure distances too far on it. The latter is a systematic error: as a variance, it counts
    /// by its square from one scan to the next.
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
        /// `drift_position_m` per metre of the tour; none where the robot need not move.
        drift_position_m_per_m: Option<f64>, "m/m";
        /// `drift_heading_rad` per metre of the tour; none where the robot need not move.
        drift_heading_rad_per_m: Option<f64>, "rad/m";
        /// `drift_map_m` per metre of the tour; none where the robot need not move.
        drift_map_m_per_m: Option<f64>, "m/m";
        /// Root of the greatest sum of u from a scan that holds the position well, with l2 of 10 or more,
        /// to the next such scan, or to the tour's end.
        drift_worst_gap_m: f64, "m";
    }
}

impl Drift {
    pub(super) fn of(stops: &[Stop], platform: &Platform) -> Self {
        let trust = USED / (platform.sigma * platform.sigma);
        let (mut position, mut heading, mut map, mut length) = (0.0, 0.0, 0.0, 0.0);
        let (mut gap, mut worst_gap) = (0.0, 0.0_f64);
        for stop in stops {
            let leg = stop.leg;
            let (ds, turn) = (leg.distance + leg.slip_distance, leg.turning + leg.slip_turning);
            let systematic = leg.wheel_bias * leg.wheel_bias;
            let least = stop.information.least;
            let added = left(platform.k_ss * ds + platform.k_st * turn + systematic, trust * least);
            position += added;
            heading +=
                left(platform.k_tt * turn + platform.k_ts * ds, trust * stop.information.heading);
            map += position + heading * stop.position.distance_squared(stops[0].position);
            length += leg.distance;
            gap += added;
            worst_gap = worst_gap.max(gap);
            if least >= WELL_HELD {
                gap = 0.0;
            }
        }
        let map = f64::sqrt(map / stops.len().max(1) as f64);
        let (position_m, heading_rad) = (f64::sqrt(position), f64::sqrt(heading));
        let per_metre = |drift: f64| (length > 0.0).then(|| drift / length);
        Drift {
            drift_position_m: position_m,
            drift_heading_rad: heading_rad,
            drift_map_m: map,
            drift_rate_m_per_root_m: per_metre(position).map(f64::sqrt),
            drift_position_m_per_m: per_metre(position_m),
            drift_heading_rad_per_m: per_metre(heading_rad),
            drift_map_m_per_m: per_metre(map),
            drift_worst_gap_m: worst_gap.sqrt(),
        }
    }
}

/// Returns the variance that remains after a measurement of some information.
fn left(variance: f64, information: f64) -> f64 {
    variance / (1.0 + variance * information)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::super::information::ScanInformation;
    use super::super::leg::Leg;
    use super::*;

    fn straight(information: ScanInformation) -> Vec<Stop> {
        let leg = Leg { distance: 0.5, turning: 0.1, ..Default::default() };
        let stop = |i: i32| Stop {
            position: DVec2::new(0.5 * f64::from(i), 0.0),
            leg: if i == 0 { Leg::default() } else { leg },
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
        assert_eq!(drift.drift_position_m_per_m, Some(drift.drift_position_m / 20.0));
        assert_eq!(drift.drift_worst_gap_m, drift.drift_position_m);
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
    fn loose_ground_adds_its_systematic_error() {
        let platform = Platform { k_ss: 0.0, k_st: 0.0, ..Default::default() };
        let mut stops = straight(ScanInformation::default());
        stops[1..].iter_mut().for_each(|stop| stop.leg.wheel_bias = 0.2 * stop.leg.distance);
        let drift = Drift::of(&stops, &platform);
        // 40 legs, each 0.1 m too long.
        assert!((drift.drift_position_m - 0.4_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_worst_gap_lies_between_two_scans_that_hold_the_position() {
        let platform = Platform { k_ss: 2e-4, k_st: 0.0, ..Default::default() };
        let mut stops = straight(ScanInformation::default());
        for i in [4, 6, 30] {
            stops[i].information.least = 1e12;
        }
        let drift = Drift::of(&stops, &platform);
        // From scan 6 to scan 30, which leaves nothing: 23 legs of 0.5 m.
        assert!((drift.drift_worst_gap_m - (23.0 * 1e-4_f64).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_robot_that_stays_does_not_drift() {
        let drift = Drift::of(&straight(ScanInformation::default())[..1], &Platform::default());
        assert_eq!(drift.drift_position_m, 0.0);
        assert_eq!((drift.drift_rate_m_per_root_m, drift.drift_map_m_per_m), (None, None));
        assert_eq!(drift.drift_worst_gap_m, 0.0);
    }
}
