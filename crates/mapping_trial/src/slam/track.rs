//! One robot's trajectory, as its wheels measure it from keyframe to keyframe.

use envgen::geometry::Pose;

use super::motion::{advance, believable};
use crate::odometry::Increment;

/// Path length in metres after which a scan is added to the map.
pub(crate) const KEYFRAME_DISTANCE: f64 = 0.3;

/// Turning in radians after which it is added, too.
pub(crate) const KEYFRAME_TURN: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Variance of a position per path length, m^2/m, as estimators assume it: a little more than that of
/// a skid-steered robot, whose systematic errors are not modelled otherwise.
const VARIANCE_BY_DISTANCE: f64 = 1e-3;

/// Variance of a heading per turning and per path length, rad^2/rad and rad^2/m, likewise.
const VARIANCE_BY_TURN: (f64, f64) = (3e-3, 1e-4);

/// Variances of a position (m^2, along the worse axis) and of a heading (rad^2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Variance {
    pub(crate) position: f64,
    pub(crate) heading: f64,
}

impl Variance {
    /// The variance that wheels add over a path with some turning.
    pub(crate) fn of_motion(distance: f64, turned: f64) -> Variance {
        let (by_turn, by_way) = VARIANCE_BY_TURN;
        Variance {
            position: VARIANCE_BY_DISTANCE * distance,
            heading: by_turn * turned + by_way * distance,
        }
    }

    /// The variance at the end of a step whose own variance is `step`; an error of the heading
    /// becomes one of the position.
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
    /// The pose now, as seen from the last keyframe (from the start before there is one).
    pub(crate) relative: Pose,
    /// Metres since the last keyframe.
    pub(crate) distance: f64,
    /// Radians since the last keyframe, left and right added.
    pub(crate) turned: f64,
    /// Metres and radians since the pose was last corrected.
    loose: (f64, f64),
    /// Metres since the start.
    pub(crate) total: f64,
    /// The keyframe of each step, and the pose seen from it.
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

    /// Moves on; a call of [`PoseTrack::record`] must follow.
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

    /// Corrects the pose now, as seen from the last keyframe.
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

    /// Continues from a keyframe at the pose now.
    pub(crate) fn restart(&mut self, keyframe: usize) {
        self.keyframe = Some(keyframe);
        (self.distance, self.turned) = (0.0, 0.0);
        self.correct(Pose::default());
    }

    /// Records a step.
    pub(crate) fn record(&mut self) {
        self.steps.push((self.keyframe.map(|keyframe| keyframe as u32), self.relative));
    }

    /// The pose now, given those of keyframes.
    pub(crate) fn pose(&self, keyframe: impl Fn(usize) -> Pose) -> Pose {
        self.keyframe.map_or(self.start, keyframe).compose(self.relative)
    }

    /// The poses at the start and after each step, given those of keyframes.
    pub(crate) fn poses(&self, keyframe: impl Fn(usize) -> Pose) -> Vec<Pose> {
        let base = |from: Option<u32>| from.map_or(self.start, |from| keyframe(from as usize));
        let steps = self.steps.iter().map(|&(from, relative)| base(from).compose(relative));
        std::iter::once(self.start).chain(steps).collect()
    }
}
