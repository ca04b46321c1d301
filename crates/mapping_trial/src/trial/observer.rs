//! Watching a trial while it runs: for recordings and displays.

use envgen::geometry::Pose;

use crate::backend::Observation;
use crate::slam::Slam;

/// Watches a trial and changes nothing in it. Plugged in by
/// [`TrialParts::observer`](super::TrialParts::observer).
pub trait TrialObserver {
    /// Takes what one robot measured in one tick, after SLAM has processed it and before the policy decides.
    /// Robots whose part has ended are not observed any more.
    fn observe(&mut self, moment: &Moment<'_>);
}

/// One robot in one tick of a trial.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The robot's number, from 0.
    pub robot: usize,
    /// What it measured.
    pub seen: &'a Observation,
    /// Its true pose in the world's frame.
    pub pose: Pose,
    /// The estimated poses and the map so far.
    pub slam: &'a dyn Slam,
}
