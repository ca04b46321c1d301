//! Exploration policies, which decide where a robot goes next from the estimated map alone.

mod cautious;
mod corridors;
pub mod costmap;
mod exploration_policy;
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
mod tour;
mod wall_follow;

use serde::{Deserialize, Serialize};

pub use exploration_policy::{Decision, ExplorationPolicy, PolicyInput};

use crate::lidar::LaserProfile;
use crate::robot::Robot;

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
    /// Goes where it sees most unknown space per metre of path.
    InfoGain,
    /// As `nearest`, but returns to an earlier position if its pose is uncertain.
    Cautious,
    /// Follows the wall on its right hand.
    WallFollow,
    /// Explores hallways first and rooms later, with a reaction time, as the operators of Zwennes
    /// (2011) described.
    Corridors,
    /// Goes to the first of the eight nearest frontiers on the shortest path through all of them.
    Tour,
}

/// Creates the policy of a kind for this number of equal robots.
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
        PolicyKind::Tour => Box::new(tour::Tour::new(navigator)),
    }
}

#[cfg(test)]
mod tests;
