//! Exploration policies: they decide where a robot goes next, on the estimated map alone.

mod cautious;
mod corridors;
pub mod costmap;
pub mod frontier;
mod guard;
mod inflation;
mod info_gain;
pub(crate) mod margins;
mod navigator;
mod nearest;
mod path;
mod pursuit;
pub mod search;
mod wall_follow;

use envgen::geometry::Rect;
use glam::DVec2;
use serde::{Deserialize, Serialize};

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

/// The built-in policies.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::names::Named;
/// use mapping_trial::policy::PolicyKind;
/// use mapping_trial::trial::{EndReason, Trial, TrialSettings};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let policy = Some(PolicyKind::named("wall_follow")?);
/// let settings = TrialSettings { policy, time_limit: 60.0, ..Default::default() };
/// let mut trial = Trial::flat(&world, settings)?;
/// while trial.step() {}
/// assert_eq!(trial.end_of(0).map(|end| end.reason), Some(EndReason::Explored));
/// assert!(trial.trajectory(0).distance > 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PolicyKind {
    /// Goes to the nearest frontier.
    Nearest,
    /// Goes where most unknown space is seen per metre of path.
    InfoGain,
    /// As `nearest`, but goes back to an old position if its pose is uncertain.
    Cautious,
    /// Follows the wall on its right hand.
    WallFollow,
    /// Hallways first, rooms later, with a delay of reaction: what the operators of Zwennes (2011)
    /// described.
    Corridors,
}

/// The policy of a kind for this number of equal robots.
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
