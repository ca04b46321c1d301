//! Alignment: the rigid motion of the plane that brings one trajectory nearest to another.

use envgen::geometry::Pose;
use glam::DVec2;

use super::trajectory_pair::TrajectoryPair;

/// Returns the pose of the estimate's frame in the world's frame for which the squared position errors
/// are least, without a change of scale (Umeyama, Least-squares estimation of transformation parameters
/// between two point patterns, IEEE TPAMI 13, 1991, <https://doi.org/10.1109/34.88573>, in the plane).
/// Without poses it is the identity. If no rotation is better than another, it is a translation.
///
/// ```
/// use envgen::geometry::Pose;
/// use mapping_trial::score::{TrajectoryPair, alignment};
///
/// let frame = Pose::new(3.0, -1.0, 0.5);
/// let estimated = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0)].map(|(x, y)| Pose::new(x, y, 0.0));
/// let truth = estimated.map(|pose| frame.compose(pose));
/// let found = alignment(&TrajectoryPair { truth: &truth, estimated: &estimated });
/// assert!(found.position.distance(frame.position) < 1e-12);
/// assert!((found.heading - 0.5).abs() < 1e-12);
/// ```
pub fn alignment(track: &TrajectoryPair<'_>) -> Pose {
    let count = track.truth.len().min(track.estimated.len());
    if count == 0 {
        return Pose::default();
    }
    let mean = |poses: &[Pose]| {
        poses[..count].iter().map(|pose| pose.position).sum::<DVec2>() / count as f64
    };
    let (to, from) = (mean(track.truth), mean(track.estimated));
    let (mut along, mut across) = (0.0, 0.0);
    for (truth, estimated) in track.truth.iter().zip(track.estimated) {
        let (p, e) = (truth.position - to, estimated.position - from);
        along += e.dot(p);
        across += e.perp_dot(p);
    }
    let turn = Pose { position: DVec2::ZERO, heading: libm::atan2(across, along) };
    Pose { position: to - turn.to_world(from), heading: turn.heading }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::score::TrajectoryScores;

    fn pose() -> impl Strategy<Value = Pose> {
        (-9.0..9.0_f64, -9.0..9.0_f64, -3.1..3.1_f64).prop_map(|(x, y, h)| Pose::new(x, y, h))
    }

    #[test]
    fn nothing_to_align_leaves_the_frame() {
        assert_eq!(alignment(&TrajectoryPair { truth: &[], estimated: &[] }), Pose::default());
        let (a, b) = ([Pose::new(1.0, 2.0, 0.3)], [Pose::new(4.0, 4.0, 0.1)]);
        let found = alignment(&TrajectoryPair { truth: &a, estimated: &b });
        assert_eq!((found.position, found.heading), (DVec2::new(-3.0, -2.0), 0.0));
    }

    proptest! {
        #[test]
        fn no_other_motion_has_a_smaller_error(
            poses in proptest::collection::vec((pose(), pose()), 2..20), by in pose(),
        ) {
            let (truth, estimated): (Vec<Pose>, Vec<Pose>) = poses.into_iter().unzip();
            let best = alignment(&TrajectoryPair { truth: &truth, estimated: &estimated });
            let error = |frame: Pose| {
                let moved: Vec<Pose> = estimated.iter().map(|pose| frame.compose(*pose)).collect();
                let track = TrajectoryPair { truth: &truth, estimated: &moved };
                TrajectoryScores::of(&[track]).expect("finite").trajectory_error
            };
            for part in [1.0, 0.1, 1e-3] {
                let change = Pose { position: by.position * part, heading: by.heading * part };
                prop_assert!(error(best) <= error(best.compose(change)) + 1e-12);
            }
        }
    }
}
