//! The true and the estimated trajectory of a robot.

use envgen::geometry::Pose;

use super::error::{MAX_POSITION, ScoreError};

/// The true and the estimated poses of one robot, tick by tick.
#[derive(Clone, Copy, Debug)]
pub struct TrajectoryPair<'a> {
    /// True poses.
    pub truth: &'a [Pose],
    /// Estimated poses, as many as true ones.
    pub estimated: &'a [Pose],
}

/// Checks that a pair's lists have the same length, and that poses are finite.
pub(super) fn check_tracks(tracks: &[TrajectoryPair<'_>]) -> Result<(), ScoreError> {
    for (robot, track) in tracks.iter().enumerate() {
        let (truth, estimated) = (track.truth.len(), track.estimated.len());
        if truth != estimated {
            return Err(ScoreError::Lengths { robot, truth, estimated });
        }
        let finite = |pose: &Pose| {
            pose.position.abs().max_element() <= MAX_POSITION
                && pose.position.is_finite()
                && pose.heading.abs() <= MAX_POSITION
        };
        let poses = track.truth.iter().zip(track.estimated);
        let mut poses = poses.map(|(truth, estimated)| finite(truth) && finite(estimated));
        if let Some(tick) = poses.position(|finite| !finite) {
            return Err(ScoreError::Pose { robot, tick });
        }
    }
    Ok(())
}
