//! What a SLAM estimator does.

use envgen::geometry::Pose;

use crate::backend::Observation;
use crate::map::{Estimate, OccupancyMap};

/// A SLAM estimator, for one robot or several that share one map.
///
/// Robots know where they start; the map's frame is the one in which those poses are given. Changes of
/// the map are announced by [`OccupancyMap::touch`]: policies and scores look only there.
///
/// An estimator of your own is plugged in by [`TrialBuilder::slam`](crate::trial::TrialBuilder::slam).
pub trait Slam {
    /// Its name in logs and reports of trials that it is plugged into; the type's path by
    /// default.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// Takes what one robot measured in one tick.
    fn step(&mut self, robot: usize, seen: &Observation);

    /// The pose estimate of a robot, in the map's frame.
    fn estimate(&self, robot: usize) -> Estimate;

    /// The map so far.
    fn map(&self) -> &OccupancyMap;

    /// The best estimate now of a robot's pose after each of its steps, the start first: one pose
    /// more than steps. Loop closing may change the past.
    fn trajectory(&self, robot: usize) -> Vec<Pose>;
}
