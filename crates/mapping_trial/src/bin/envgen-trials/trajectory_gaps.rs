//! What trajectories lack.

use envgen::geometry::wrap_angle;
use mapping_trial::tum::TimedPose;

/// The distance in metres on the true path between two poses of an estimate that does not count as missing.
const GAP: f64 = 1.0;

/// The longest time in seconds between true poses of a moving robot between which its pose is interpolated: a robot that
/// brakes by 1 m/s^2 is within a centimetre of it.
pub(crate) const LONGEST: f64 = 0.25;

/// The time in seconds from a true pose for which it is known, also in a gap.
const NEAR: f64 = 0.02;

/// The least motion in a gap between true poses, in metres and radians. An error of this heading is one of 10 cm after
/// 20 m.
const LEAST_MOTION: f64 = 0.005;

/// The gaps of a true trajectory, in which the robot moves and its poses are not known.
pub(crate) struct Gaps(Vec<(f64, f64)>);

impl Gaps {
    pub(crate) fn of(truth: &[TimedPose]) -> Self {
        let is_long = |pair: &&[TimedPose]| pair[1].time - pair[0].time > LONGEST;
        let moves = |pair: &&[TimedPose]| {
            let (a, b) = (pair[0].pose, pair[1].pose);
            a.position.distance(b.position) > LEAST_MOTION
                || wrap_angle(b.heading - a.heading).abs() > LEAST_MOTION
        };
        let gaps = truth.windows(2).filter(is_long).filter(moves);
        Gaps(gaps.map(|pair| (pair[0].time, pair[1].time)).collect())
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Start and end of the longest gap, in seconds.
    pub(crate) fn longest(&self) -> Option<(f64, f64)> {
        self.0.iter().copied().max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
    }

    /// Whether a time lies in a gap, and not close to an end of it.
    pub(crate) fn contain(&self, time: f64) -> bool {
        let after = self.0.partition_point(|gap| gap.1 - NEAR <= time);
        self.0.get(after).is_some_and(|gap| gap.0 + NEAR < time)
    }
}

/// The fraction of the true path's length that lies in gaps of an estimate, each without its first metre.
pub(crate) fn missing_share(estimated: &[TimedPose], truth: &[TimedPose]) -> f64 {
    let mut driven = vec![0.0];
    for pair in truth.windows(2) {
        let step = pair[0].pose.position.distance(pair[1].pose.position);
        driven.push(driven[driven.len() - 1] + step);
    }
    let whole = driven[driven.len() - 1];
    let driven_at = |time: f64| {
        let next = truth.partition_point(|pose| pose.time <= time);
        if next == 0 || next == truth.len() {
            return if next == 0 { 0.0 } else { whole };
        }
        let part = (time - truth[next - 1].time) / (truth[next].time - truth[next - 1].time);
        driven[next - 1] + part * (driven[next] - driven[next - 1])
    };
    let mut seen: Vec<f64> = estimated.iter().map(|pose| driven_at(pose.time)).collect();
    seen.extend([0.0, whole]);
    seen.sort_by(f64::total_cmp);
    let missing: f64 = seen.windows(2).map(|pair| (pair[1] - pair[0] - GAP).max(0.0)).sum();
    if whole > 0.0 { missing / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use envgen::geometry::Pose;

    use super::*;

    /// Poses on a straight path of 10 m at 1 m/s, one every `step` seconds up to `end`.
    fn poses(step: f64, end: f64) -> Vec<TimedPose> {
        let count = (end / step).round() as u32;
        let times = (0..=count).map(|i| step * f64::from(i));
        times.map(|time| TimedPose { time, pose: Pose::new(time, 0.0, 0.0) }).collect()
    }

    #[test]
    fn what_an_estimate_lacks_is_a_part_of_the_path() {
        for truth in [poses(0.05, 10.0), poses(2.0, 10.0), poses(10.0, 10.0)] {
            for (estimate, expected) in [
                (poses(0.05, 10.0), 0.0),
                (poses(1.0, 10.0), 0.0),
                // Of every 2 m, the second.
                (poses(2.0, 10.0), 0.5),
                (poses(0.05, 4.0), 0.5),
                (poses(0.05, 0.05), 0.895),
            ] {
                let missing = missing_share(&estimate, &truth);
                assert!((missing - expected).abs() < 1e-9, "{missing}, not {expected}");
            }
        }
        assert_eq!(missing_share(&poses(1.0, 3.0), &poses(1.0, 0.0)), 0.0);
    }

    #[test]
    fn gaps_are_where_the_robot_moves_unseen() {
        for step in [0.05, 0.2] {
            let mut truth = poses(step, 20.0);
            assert_eq!(Gaps::of(&truth).longest(), None);
            truth.retain(|pose| pose.time <= 8.0 || pose.time >= 14.0);
            let gaps = Gaps::of(&truth);
            let (start, end) = gaps.longest().expect("a gap");
            assert!((start - 8.0).abs() < 1e-9 && (end - 14.0).abs() < 1e-9, "{start} {end}");
            assert_eq!(gaps.count(), 1);
            assert!(gaps.contain(8.5) && gaps.contain(13.9));
            assert!(!gaps.contain(start) && !gaps.contain(end) && !gaps.contain(3.0));
            assert!(!gaps.contain(start + 0.01) && !gaps.contain(end - 0.01));
            assert!(gaps.contain(start + 0.03) && gaps.contain(end - 0.03));
            // A robot that does not move was where it is.
            truth.iter_mut().for_each(|pose| pose.pose = Pose::default());
            assert_eq!(Gaps::of(&truth).longest(), None);
        }
        // Where poses are rare, each pair of them has a gap in between.
        let rare = Gaps::of(&poses(1.0, 20.0));
        assert_eq!((rare.count(), rare.longest()), (20, Some((19.0, 20.0))));
        assert!(rare.contain(3.5) && !rare.contain(3.0) && !rare.contain(4.0));
        assert_eq!(Gaps::of(&[]).longest(), None);
    }
}
