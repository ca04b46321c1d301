//! The track of one robot: its trajectory as its wheels measure it from keyframe to keyframe.

use envgen::geometry::Pose;

use super::motion::{advance, believable};
use crate::odometry::Increment;

/// Path length in metres after which a scan becomes a keyframe.
pub(crate) const KEYFRAME_DISTANCE: f64 = 0.3;

/// Turning in radians after which a scan becomes a keyframe, too.
pub(crate) const KEYFRAME_TURN: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Variance of a position per path length, m^2/m, as estimators assume it. It is a little more than
/// that of a skid-steered robot, since systematic errors are not modelled otherwise.
const VARIANCE_BY_DISTANCE: f64 = 1e-3;

/// Variance of a heading per turning, rad^2/rad, and per path length, rad^2/m, likewise.
const VARIANCE_BY_TURN: (f64, f64) = (3e-3, 1e-4);

/// Variances of a position (m^2, along the axis where it is larger) and of a heading (rad^2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Variance {
    pub(crate) position: f64,
    pub(crate) heading: f64,
}

impl Variance {
    /// The variance that wheels add over a path of some length and turning.
    pub(crate) fn of_motion(distance: f64, turned: f64) -> Variance {
        let (by_turn, by_way) = VARIANCE_BY_TURN;
        Variance {
            position: VARIANCE_BY_DISTANCE * distance,
            heading: by_turn * turned + by_way * distance,
        }
    }

    /// The variance at the end of a step whose own variance is `step`. An error of the heading becomes
    /// one of the position.
    pub(crate) fn after(self, step: Variance, distance: f64) -> Variance {
        Variance {
            position: self.position + step.position + distance * distance * self.heading,
            heading: self.heading + step.heading,
        }
    }
}

/// A robot's trajectory so far.
#[derive(Clone, Debug)]
pub(crate) struct PoseTrack {
    start: Pose,
    /// The last keyframe; `None` before the first scan.
    pub(crate) keyframe: Option<usize>,
    /// The present pose relative to the last keyframe, or to the start before the first keyframe.
    pub(crate) relative: Pose,
    /// Path length in metres since the last keyframe.
    pub(crate) distance: f64,
    /// Turning in radians since the last keyframe, left and right added.
    pub(crate) turned: f64,
    /// Path length in metres and turning in radians since the pose was last corrected.
    loose: (f64, f64),
    /// Path length in metres since the start.
    pub(crate) total: f64,
    /// The keyframe of each step, and the pose relative to it.
    steps: Vec<(Option<u32>, Pose)>,
}

impl PoseTrack {
    /// The trajectory of a robot that has not moved.
    pub(crate) fn new(start: Pose) -> Self {
        let finite = start.position.is_finite() && start.heading.is_finite();
        PoseTrack {
            start: if finite { start } else { Pose::default() },
            keyframe: None,
            relative: Pose::default(),
            distance: 0.0,
            turned: 0.0,
            loose: (0.0, 0.0),
            total: 0.0,
            steps: Vec::new(),
        }
    }

    /// Moves by an increment of odometry. A call of [`PoseTrack::record`] must follow.
    pub(crate) fn advance(&mut self, odometry: Increment) {
        let by = believable(odometry);
        self.relative = advance(self.relative, by);
        self.distance += by.distance.abs();
        self.turned += by.turn.abs();
        self.total += by.distance.abs();
        self.loose.0 += by.distance.abs();
        self.loose.1 += by.turn.abs();
    }

    /// The variance of the motion since the last correction.
    pub(crate) fn loose(&self) -> Variance {
        Variance::of_motion(self.loose.0, self.loose.1)
    }

    /// Corrects the present pose, which is given relative to the last keyframe.
    pub(crate) fn correct(&mut self, relative: Pose) {
        self.relative = relative;
        self.loose = (0.0, 0.0);
    }

    /// Whether a scan taken now is worth a keyframe.
    pub(crate) fn is_keyframe_due(&self) -> bool {
        self.keyframe.is_none()
            || self.distance >= KEYFRAME_DISTANCE
            || self.turned >= KEYFRAME_TURN
    }

    /// Continues from a keyframe at the present pose.
    pub(crate) fn restart(&mut self, keyframe: usize) {
        self.keyframe = Some(keyframe);
        (self.distance, self.turned) = (0.0, 0.0);
        self.correct(Pose::default());
    }

    /// Records a step.
    pub(crate) fn record(&mut self) {
        self.steps.push((self.keyframe.map(|keyframe| keyframe as u32), self.relative));
    }

    /// Returns the present pose, given those of keyframes.
    pub(crate) fn pose(&self, keyframe: impl Fn(usize) -> Pose) -> Pose {
        self.keyframe.map_or(self.start, keyframe).compose(self.relative)
    }

    /// Returns the poses at the start and after each step, given those of keyframes.
    pub(crate) fn poses(&self, keyframe: impl Fn(usize) -> Pose) -> Vec<Pose> {
        let base = |from: Option<u32>| from.map_or(self.start, |from| keyframe(from as usize));
        let steps = self.steps.iter().map(|&(from, relative)| base(from).compose(relative));
        std::iter::once(self.start).chain(steps).collect()
    }
}
