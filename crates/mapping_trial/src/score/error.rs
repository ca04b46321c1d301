//! Errors of scoring.

use glam::DVec2;
use thiserror::Error;

/// Greatest coordinate of a pose in metres, and greatest heading in radians.
pub(super) const MAX_POSITION: f64 = 1e9;

/// An error for which a run has no scores.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// A trajectory does not have as many estimated poses as true ones.
    #[error("`estimated` of robot {robot} has {estimated} poses, expected {truth}, one per tick")]
    Lengths {
        /// The robot.
        robot: usize,
        /// Number of true poses.
        truth: usize,
        /// Number of estimated poses.
        estimated: usize,
    },
    /// An estimator's trajectory does not have a pose for each step.
    #[error(
        "the estimated trajectory of robot {robot} has {found} poses, expected {expected}, the start and one per step"
    )]
    Trajectory {
        /// The robot.
        robot: usize,
        /// Number of poses of the trajectory.
        found: u64,
        /// Number of poses that it has to have.
        expected: u64,
    },
    /// A pose is not finite, or too far from the origin.
    #[error("pose {tick} of robot {robot} is not within {MAX_POSITION} m of the origin")]
    Pose {
        /// The robot.
        robot: usize,
        /// The tick.
        tick: usize,
    },
    /// The mappable area is for another start or robot.
    #[error(
        "the mappable area is for a robot of {found_radius} m that starts at ({}, {}), \
         the trial's has {radius} m and starts at ({}, {}): use `Trial::reference`",
        found.x, found.y, start.x, start.y
    )]
    Reference {
        /// Start of the mappable area.
        found: DVec2,
        /// Radius in metres of the mappable area's robot.
        found_radius: f64,
        /// Start of the trial.
        start: DVec2,
        /// Radius in metres of the trial's robot.
        radius: f64,
    },
    /// The mappable area is for a robot of another height, speed, laser or other property.
    #[error(
        "the mappable area is for another robot than that of the trial: use `Trial::reference`"
    )]
    OtherRobot,
    /// A number of the run is NaN, infinite or negative.
    #[error("`{field}` must be a finite number of 0 or more, got {value}")]
    Number {
        /// The field of [`RunSummary`](super::RunSummary).
        field: &'static str,
        /// Its value.
        value: f64,
    },
}
