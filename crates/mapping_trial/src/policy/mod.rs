//! Operators: who decides where a robot goes next, on the estimated map alone.

mod cautious;
mod corridors;
pub mod costmap;
pub mod frontier;
mod guard;
mod inflation;
mod info_gain;
mod margins;
mod navigator;
mod nearest;
mod path;
mod pursuit;
pub mod search;
mod wall_follow;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::backend::{Command, Observation};
use crate::lidar::{LaserProfile, Scan};
use crate::map::{Estimate, OccupancyMap};
use crate::robot::Robot;

/// What an operator sees when it is asked for one robot's command.
#[derive(Clone, Copy, Debug)]
pub struct PolicyInput<'a> {
    /// The robot that is asked for.
    pub robot: usize,
    /// Where each robot is thought to be.
    pub estimates: &'a [Estimate],
    /// The map so far.
    pub map: &'a OccupancyMap,
    /// This robot's last scan, as seen from where its laser was then.
    pub scan: &'a Scan,
    /// Where this robot last saw water, in the map's frame; empty where it saw none.
    pub water: &'a [DVec2],
    /// What this robot measured in this tick: time, odometry, bumper, battery.
    pub seen: &'a Observation,
    /// Size and limits of the robots.
    pub body: &'a Robot,
    /// What their lasers measure.
    pub laser: &'a LaserProfile,
}

/// What an operator wants of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision {
    /// Carry out this command until asked again.
    Drive(Command),
    /// There is nothing left to explore that this robot can reach.
    Finished,
    /// The robot cannot get free.
    Stuck,
    /// The operator itself broke down, as [`ExplorationPolicy::failure`] says: the trial ends.
    Failed,
}

/// An operator of one or more robots: an exploration policy.
///
/// One of your own is plugged in by [`TrialBuilder::policy`](crate::trial::TrialBuilder::policy).
pub trait ExplorationPolicy {
    /// What logs and reports call it where it was plugged in: the type's path unless it says
    /// otherwise.
    fn name(&self) -> &str {
        std::any::type_name::<Self>()
    }

    /// What a robot is to do now; asked every [`ExplorationPolicy::ticks_per_decision`] ticks.
    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision;

    /// Ticks from one decision to the next, at least 1: 2 are 10 decisions a second.
    fn ticks_per_decision(&self) -> u64 {
        2
    }

    /// How often a robot had to be freed so far.
    fn recoveries(&self, _robot: usize) -> u32 {
        0
    }

    /// The path that a robot is following, for pictures: points in the map's frame.
    fn path(&self, _robot: usize) -> &[DVec2] {
        &[]
    }

    /// Why it decided on [`Decision::Failed`]; `None` while it works.
    fn failure(&self) -> Option<&str> {
        None
    }
}

/// The operators that are programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PolicyKind {
    /// Goes to the nearest frontier.
    Nearest,
    /// Goes where most unknown space is seen for the way.
    InfoGain,
    /// As `nearest`, but goes back to an old place when its pose is uncertain.
    Cautious,
    /// Follows the wall on its right hand.
    WallFollow,
    /// Hallways first, rooms later, with a delay of reaction: what the operators of Zwennes (2011)
    /// described.
    Corridors,
}

/// The operator of a kind for so many robots of one sort.
pub fn build(
    kind: PolicyKind,
    robots: usize,
    robot: &Robot,
    laser: &LaserProfile,
) -> Box<dyn ExplorationPolicy + Send + Sync> {
    let navigator = navigator::Navigator::new(robots, robot, laser);
    match kind {
        PolicyKind::Nearest => Box::new(nearest::Nearest(navigator)),
        PolicyKind::InfoGain => Box::new(info_gain::InfoGain::new(navigator)),
        PolicyKind::Cautious => Box::new(cautious::Cautious::new(navigator, robots)),
        PolicyKind::WallFollow => Box::new(wall_follow::WallFollow::new(navigator, robots)),
        PolicyKind::Corridors => Box::new(corridors::Corridors::new(navigator, robots)),
    }
}

#[cfg(test)]
mod tests;
