//! The interface of SLAM estimators.

use envgen::geometry::Pose;

use crate::backend::Observation;
use crate::map::{Estimate, OccupancyMap};

/// A SLAM estimator for one robot, or for several that share one map.
///
/// Robots know where they start, and the map's frame is that of their start poses. An estimator has to
/// announce changes of the map by [`OccupancyMap::touch`], since policies and scores look only there. One that gets whole
/// maps, for example from another program, takes them over with [`OccupancyMap::replace`].
///
/// A custom estimator is plugged in with [`TrialBuilder::slam`](crate::trial::TrialBuilder::slam).
pub trait Slam {
    /// Returns the name of a plugged-in estimator for logs and reports. The default is the path of the
    /// type.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// Processes what one robot measured in one tick.
    fn step(&mut self, robot: usize, seen: &Observation);

    /// Returns the pose estimate of a robot, in the map's frame.
    fn estimate(&self, robot: usize) -> Estimate;

    /// Returns the map so far, the same [`OccupancyMap`] each time: policies look only at what is newer than the
    /// revision that they saw last.
    fn map(&self) -> &OccupancyMap;

    /// Returns the present best estimates of a robot's past poses: the start, and the pose after each
    /// of its steps. Loop closing may change past poses.
    fn trajectory(&self, robot: usize) -> Vec<Pose>;
}
