//! Estimators that never change what is already in the map: dead reckoning and scan-to-map matching.

use envgen::geometry::Pose;

use super::estimator::Slam;
use super::mapper::Mapper;
use super::wheel_calibration::WheelCalibration;
use crate::backend::Observation;
use crate::lidar::LaserProfile;
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// Draws each keyframe's scan permanently at its estimated pose, with or without scan matching. See
/// [`DeadReckoning`] and [`ScanToMap`].
#[derive(Clone, Debug)]
pub struct Incremental<const MATCHING: bool> {
    mapper: Mapper,
}

/// Dead reckoning, the baseline: poses come from the wheels alone, and scans are drawn at these poses.
pub type DeadReckoning = Incremental<false>;

/// Scan-to-map matching without loop closing, as robots did in 2011.
///
/// Each keyframe's scan is matched against all earlier echoes, within the error that the wheels may
/// have made since walls last held the pose. Old walls that come into sight again are therefore found
/// again. The map is never corrected: an error in it stays, so that loops cost as much as they cost the
/// robots of that time.
pub type ScanToMap = Incremental<true>;

impl<const MATCHING: bool> Incremental<MATCHING> {
    /// Creates an estimator for robots at the poses `starts`.
    pub fn new(starts: &[Pose], robot: &Robot, laser: &LaserProfile) -> Self {
        Incremental { mapper: Mapper::new(starts, robot, laser, MATCHING) }
    }

    /// Sets the errors of the wheels that it learns. Without matching, it learns none.
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
