//! Estimators that never change what is already in the map: the wheels alone, and scan to map.

use envgen::geometry::Pose;

use super::estimator::Slam;
use super::mapper::Mapper;
use super::wheel_calibration::WheelCalibration;
use crate::backend::Observation;
use crate::lidar::LaserProfile;
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// Draws each keyframe's scan at its estimated pose, for good; with or without matching it
/// before. See [`DeadReckoning`] and [`ScanToMap`].
#[derive(Clone, Debug)]
pub struct Incremental<const MATCHING: bool> {
    mapper: Mapper,
}

/// Dead reckoning, the baseline: poses from the wheels alone; scans are drawn at those poses.
pub type DeadReckoning = Incremental<false>;

/// Scan to map, what robots did in 2011, without closing loops.
///
/// Each keyframe's scan is matched against all earlier echoes, within the error that the wheels may
/// have made since walls last held the pose: old walls that come into sight again are found again.
/// The map is never corrected: an error in it stays, so that loops cost as much as they cost the
/// robots of the time.
pub type ScanToMap = Incremental<true>;

impl<const MATCHING: bool> Incremental<MATCHING> {
    /// For robots at the poses `starts`.
    pub fn new(starts: &[Pose], robot: &Robot, laser: &LaserProfile) -> Self {
        Incremental { mapper: Mapper::new(starts, robot, laser, MATCHING) }
    }

    /// With other errors of the wheels to be learned; without matching none is.
    pub fn with_calibration(mut self, calibration: WheelCalibration) -> Self {
        self.mapper.calibrate(calibration);
        self
    }
}

impl<const MATCHING: bool> Slam for Incremental<MATCHING> {
    fn step(&mut self, robot: usize, seen: &Observation) {
        self.mapper.step(robot, seen.odometry, seen.scan.as_ref());
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
