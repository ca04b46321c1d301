//! One robot's way, as its wheels measure it from keyframe to keyframe.

use envgen::geometry::Pose;

use super::motion::{advance, believable, compose};
use crate::odometry::Increment;

/// Path in metres after which a scan is put into the map.
pub(crate) const KEYFRAME_WAY: f64 = 0.3;

/// Turning in radians after which it is, too.
pub(crate) const KEYFRAME_TURN: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Variance of a position by the way, m^2/m, as estimators believe it: a little more than that of a
/// skid-steered robot, whose systematic errors are not modelled otherwise.
const VARIANCE_BY_WAY: f64 = 1e-3;

/// Variance of a heading by turning and by the way, rad^2/rad and rad^2/m, likewise.
const VARIANCE_BY_TURN: (f64, f64) = (3e-3, 1e-4);

/// Variances of a position (m^2, along the worse axis) and of a heading (rad^2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Variance {
    pub(crate) position: f64,
    pub(crate) heading: f64,
}

impl Variance {
    /// What wheels add over a way with some turning.
    pub(crate) fn of_motion(way: f64, turned: f64) -> Variance {
        let (by_turn, by_way) = VARIANCE_BY_TURN;
        Variance { position: VARIANCE_BY_WAY * way, heading: by_turn * turned + by_way * way }
    }

    /// The variance at the end of a step whose own variance is `step`; an error of the heading
    /// becomes one of the position.
    pub(crate) fn after(self, step: Variance, way: f64) -> Variance {
        Variance {
            position: self.position + step.position + way * way * self.heading,
            heading: self.heading + step.heading,
        }
    }
}

/// A robot's way so far.
#[derive(Clone, Debug)]
pub(crate) struct PoseTrack {
    start: Pose,
    /// The last keyframe, none before the first scan.
    pub(crate) keyframe: Option<usize>,
    /// The pose now, as seen from the last keyframe (from the start before there is one).
    pub(crate) relative: Pose,
    /// Metres since the last keyframe.
    pub(crate) way: f64,
    /// Radians since the last keyframe, in whatever direction.
    pub(crate) turned: f64,
    /// Metres since the start.
    pub(crate) total: f64,
    /// The keyframe of each step, and the pose seen from it.
    steps: Vec<(Option<u32>, Pose)>,
}

impl PoseTrack {
    /// The way of a robot that has not moved.
    pub(crate) fn new(start: Pose) -> Self {
        let finite = start.position.is_finite() && start.heading.is_finite();
        PoseTrack {
            start: if finite { start } else { Pose::default() },
            keyframe: None,
            relative: Pose::default(),
            way: 0.0,
            turned: 0.0,
            total: 0.0,
            steps: Vec::new(),
        }
    }

    /// Moves on; [`PoseTrack::record`] is to follow.
    pub(crate) fn advance(&mut self, odometry: Increment) {
        let by = believable(odometry);
        self.relative = advance(self.relative, by);
        self.way += by.distance.abs();
        self.turned += by.turn.abs();
        self.total += by.distance.abs();
    }

    /// Whether a scan taken now is worth a keyframe.
    pub(crate) fn is_keyframe_due(&self) -> bool {
        self.keyframe.is_none() || self.way >= KEYFRAME_WAY || self.turned >= KEYFRAME_TURN
    }

    /// Goes on from a keyframe at the pose now.
    pub(crate) fn restart(&mut self, keyframe: usize) {
        self.keyframe = Some(keyframe);
        (self.relative, self.way, self.turned) = (Pose::default(), 0.0, 0.0);
    }

    /// Writes a step down.
    pub(crate) fn record(&mut self) {
        self.steps.push((self.keyframe.map(|keyframe| keyframe as u32), self.relative));
    }

    /// The pose now, given those of keyframes.
    pub(crate) fn pose(&self, keyframe: impl Fn(usize) -> Pose) -> Pose {
        compose(self.keyframe.map_or(self.start, keyframe), self.relative)
    }

    /// The poses at the start and after each step, given those of keyframes.
    pub(crate) fn poses(&self, keyframe: impl Fn(usize) -> Pose) -> Vec<Pose> {
        let base = |from: Option<u32>| from.map_or(self.start, |from| keyframe(from as usize));
        let steps = self.steps.iter().map(|&(from, relative)| compose(base(from), relative));
        std::iter::once(self.start).chain(steps).collect()
    }
}
