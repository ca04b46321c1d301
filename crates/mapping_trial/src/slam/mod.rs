//! Simultaneous localisation and mapping: from what robots measure to where they are and what is
//! around them.

use envgen::geometry::Pose;

use crate::lidar::Scan;
use crate::map::{Estimate, OccupancyMap};
use crate::odometry::Increment;

/// One way to do it, for one robot or several that share one map.
///
/// Robots know where they start; the map's frame is the one that those poses are given in.
pub trait Slam {
    /// What one robot measured in one tick.
    fn step(&mut self, robot: usize, odometry: Increment, scan: Option<&Scan>);

    /// Where a robot is thought to be.
    fn estimate(&self, robot: usize) -> Estimate;

    /// The map so far.
    fn map(&self) -> &OccupancyMap;

    /// The best guess now of where a robot was after each of its steps, the start first. Loop
    /// closing may change the past.
    fn trajectory(&self, robot: usize) -> Vec<Pose>;
}
