//! The reasons for which a robot's part in a trial ends.

use serde::{Deserialize, Serialize};

/// Why a robot's part in a trial ended.
///
/// ```
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
/// use mapping_trial::trial::{EndReason, Trial, TrialSettings};
///
/// let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
/// let settings = TrialSettings { time_limit: 2.0, ..Default::default() };
/// let mut trial = Trial::flat(&world, settings)?;
/// while trial.step() {}
/// // Two seconds are 40 ticks.
/// let end = trial.end_of(0).expect("the trial is over");
/// assert_eq!((end.reason, end.tick), (EndReason::TimeLimit, 40));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// No frontier was left that the robot could reach.
    Explored,
    /// The robot was stuck and could not free itself.
    Stuck,
    /// The policy failed: see
    /// [`ExplorationPolicy::failure`](crate::policy::ExplorationPolicy::failure).
    Failed,
    /// The robot drove into water.
    Drowned,
    /// The battery was empty.
    Battery,
    /// The time limit was reached.
    TimeLimit,
    /// A person ended the trial.
    Stopped,
    /// The robot was removed from the simulation.
    Removed,
}

impl EndReason {
    /// Returns the name of the reason in files.
    pub fn name(self) -> &'static str {
        match self {
            EndReason::Explored => "explored",
            EndReason::Stuck => "stuck",
            EndReason::Failed => "failed",
            EndReason::Drowned => "drowned",
            EndReason::Battery => "battery",
            EndReason::TimeLimit => "time_limit",
            EndReason::Stopped => "stopped",
            EndReason::Removed => "removed",
        }
    }

    /// Returns the reason in words.
    pub fn text(self) -> &'static str {
        match self {
            EndReason::Explored => "explored",
            EndReason::Stuck => "stuck",
            EndReason::Failed => "policy or driver failed",
            EndReason::Drowned => "drowned",
            EndReason::Battery => "battery empty",
            EndReason::TimeLimit => "time up",
            EndReason::Stopped => "stopped",
            EndReason::Removed => "removed",
        }
    }
}

/// Why and when a robot's part in a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotEnd {
    /// The reason.
    pub reason: EndReason,
    /// Number of ticks until the end.
    pub tick: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_in_files() {
        use EndReason::*;
        for reason in [Explored, Stuck, Failed, Drowned, Battery, TimeLimit, Stopped, Removed] {
            assert_eq!(serde_json::to_value(reason).expect("a name"), reason.name());
        }
    }
}
