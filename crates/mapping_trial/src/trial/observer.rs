//! Observers, which watch a trial while it runs, for recordings and displays.

use envgen::geometry::Pose;

use crate::backend::Observation;
use crate::slam::Slam;

/// Watches a trial and changes nothing in it. An observer is plugged in with
/// [`TrialParts::observer`](super::TrialParts::observer).
pub trait TrialObserver {
    /// Receives what one robot measured in one tick, after SLAM has processed it and before the policy
    /// decides. It is not called for robots whose part has ended.
    fn observe(&mut self, moment: &Moment<'_>);
}

/// One robot in one tick of a trial.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The robot's number, from 0.
    pub robot: usize,
    /// What the robot measured.
    pub seen: &'a Observation,
    /// The robot's true pose in the world's frame.
    pub pose: Pose,
    /// The estimator, with the poses and the map so far.
    pub slam: &'a dyn Slam,
}
