//! The interface of exploration policies: what they are asked and what they answer.

use envgen::geometry::{Pose, Rect};
use glam::DVec2;

use crate::backend::{Command, Observation};
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// The input of a policy for the decision on one robot.
#[derive(Clone, Copy, Debug)]
pub struct PolicyInput<'a> {
    /// The robot that the command is for.
    pub robot: usize,
    /// The pose estimates of all robots.
    pub estimates: &'a [Estimate],
    /// The map so far.
    pub map: &'a OccupancyMap,
    /// This robot's last scan, relative to the laser's pose when it was taken.
    pub scan: &'a Scan,
    /// Its present pose, relative to its pose at the time of the scan, by odometry.
    pub since_scan: Pose,
    /// Where this robot last saw water, in metres in the map's frame; empty if it saw none.
    pub water: &'a [DVec2],
    /// What this robot measured in this tick: time, odometry, bumper, battery.
    pub seen: &'a Observation,
    /// The size and the limits of the robots.
    pub body: &'a Robot,
    /// The profile of their lasers.
    pub laser: &'a LaserProfile,
    /// The area to map in the map's frame, which is the bounds of the world. Robots may leave it, but
    /// what lies outside is not scored.
    pub area: Rect,
    /// Whether there are doors that open and close, so that what looks like a wall may be a closed door.
    pub doors: bool,
}

/// A policy's decision on what a robot does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// Carry out this command until the next decision.
    Drive(Command),
    /// Nothing is left to explore that this robot can reach.
    Finished,
    /// The robot cannot get free.
    Stuck,
    /// The policy itself failed, and the trial ends; [`ExplorationPolicy::failure`] says why.
    Failed,
}

/// An exploration policy for one or more robots.
///
/// A custom policy is plugged in with [`TrialBuilder::policy`](crate::trial::TrialBuilder::policy).
pub trait ExplorationPolicy {
    /// Returns the name of a plugged-in policy for logs and reports. The default is the path of the
    /// type.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// Returns the decision on a robot. It is called in the first tick, and then every
    /// [`ExplorationPolicy::ticks_per_decision`] ticks.
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision;

    /// Returns the number of ticks from one decision to the next, at least 1. With 2, there are 10
    /// decisions per second.
    fn ticks_per_decision(&self) -> u64 {
        2
    }

    /// Returns the number of recoveries of a robot so far: how often it was stuck, also in a narrow gap
    /// that it tried, and freed itself.
    fn recoveries(&self, _robot: usize) -> u32 {
        0
    }

    /// Returns the path that a robot is following, for pictures: points in metres in the map's frame.
    fn path(&self, _robot: usize) -> &[DVec2] {
        &[]
    }

    /// Returns why it failed, after [`Decision::Failed`] or at the end of a trial; `None` while it works.
    fn failure(&self) -> Option<&str> {
        None
    }
}
