//! Scan to map: what robots did in 2011, without closing loops.

use envgen::geometry::Pose;

use super::Slam;
use super::mapper::Mapper;
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::odometry::Increment;
use crate::robot::Robot;

/// Each keyframe's scan is matched against all echoes before it, within what the wheels may have got
/// wrong since walls last held the pose: old walls that come into sight again are found again. What
/// was drawn stays: an error that is in the map is never mended, so that loops cost what they cost the
/// robots of the time.
#[derive(Clone, Debug)]
pub struct ScanToMap {
    mapper: Mapper,
}

impl ScanToMap {
    /// For robots that stand at `starts`.
    pub fn new(starts: &[Pose], robot: &Robot, laser: &LaserProfile) -> Self {
        ScanToMap { mapper: Mapper::new(starts, robot, laser, true) }
    }
}

impl Slam for ScanToMap {
    fn step(&mut self, robot: usize, odometry: Increment, scan: Option<&Scan>) {
        self.mapper.step(robot, odometry, scan);
    }

    fn estimate(&self, robot: usize) -> Estimate {
        self.mapper.estimate(robot)
    }

    fn map(&self) -> &OccupancyMap {
        &self.mapper.map
    }

    fn trajectory(&self, robot: usize) -> Vec<Pose> {
        self.mapper.trajectory(robot)
    }
}
