//! What a policy is asked, and what it answers.

use envgen::geometry::{Pose, Rect};
use glam::DVec2;

use crate::backend::{Command, Observation};
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// What a policy knows when it is asked for one robot's command.
#[derive(Clone, Copy, Debug)]
pub struct PolicyInput<'a> {
    /// The robot that the command is for.
    pub robot: usize,
    /// Each robot's pose estimate.
    pub estimates: &'a [Estimate],
    /// The map so far.
    pub map: &'a OccupancyMap,
    /// This robot's last scan, relative to its laser's pose at that time.
    pub scan: &'a Scan,
    /// Its pose now in the frame of its pose then, by odometry.
    pub since_scan: Pose,
    /// Where this robot last saw water, in metres in the map's frame; empty if it saw none.
    pub water: &'a [DVec2],
    /// What this robot measured in this tick: time, odometry, bumper, battery.
    pub seen: &'a Observation,
    /// Size and limits of the robots.
    pub body: &'a Robot,
    /// What their lasers measure.
    pub laser: &'a LaserProfile,
    /// The area to map, in the map's frame: the bounds of the world. Robots may leave it, but what
    /// lies outside is not scored.
    pub area: Rect,
}

/// The decision of a policy for a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// Carry out this command until the next decision.
    Drive(Command),
    /// Nothing is left to explore that this robot can reach.
    Finished,
    /// The robot cannot get free.
    Stuck,
    /// The policy itself failed, as [`ExplorationPolicy::failure`] says: the trial ends.
    Failed,
}

/// An exploration policy for one or more robots.
///
/// One of your own is plugged in by [`TrialBuilder::policy`](crate::trial::TrialBuilder::policy).
pub trait ExplorationPolicy {
    /// Its name in logs and reports of trials that it is plugged into; the type's path by
    /// default.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// The decision for a robot now; called every [`ExplorationPolicy::ticks_per_decision`] ticks.
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision;

    /// Ticks from one decision to the next, at least 1: 2 are 10 decisions per second.
    fn ticks_per_decision(&self) -> u64 {
        2
    }

    /// Number of recoveries of a robot so far: how often it was stuck and freed itself.
    fn recoveries(&self, _robot: usize) -> u32 {
        0
    }

    /// The path that a robot is following, for pictures: points in metres in the map's frame.
    fn path(&self, _robot: usize) -> &[DVec2] {
        &[]
    }

    /// Why it decided on [`Decision::Failed`]; `None` while it works.
    fn failure(&self) -> Option<&str> {
        None
    }
}
