//! Dead reckoning: the control, which believes the wheels.

use envgen::geometry::Pose;

use super::Slam;
use super::mapper::Mapper;
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::odometry::Increment;
use crate::robot::Robot;

/// Poses from the wheels alone; scans are drawn where those say.
#[derive(Clone, Debug)]
pub struct DeadReckoning {
    mapper: Mapper,
}

impl DeadReckoning {
    /// For robots that stand at `starts`.
    pub fn new(starts: &[Pose], robot: &Robot, laser: &LaserProfile) -> Self {
        DeadReckoning { mapper: Mapper::new(starts, robot, laser, false) }
    }
}

impl Slam for DeadReckoning {
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
