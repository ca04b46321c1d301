//! What a log knows of a policy.

use super::end::{EndReason, RobotEnd};

/// What a log knows of a policy, which is not asked again in a replay.
#[derive(Clone, Debug)]
pub(super) struct Script {
    pub(super) ends: Vec<Option<RobotEnd>>,
    pub(super) recoveries: Vec<u32>,
}

impl Script {
    /// Returns why a robot's part ends at a tick. A stop by a person is not in the script.
    pub(super) fn end_at(&self, robot: usize, tick: u64) -> Option<EndReason> {
        let end = (*self.ends.get(robot)?)?;
        (end.tick == tick && end.reason != EndReason::Stopped).then_some(end.reason)
    }

    pub(super) fn recoveries(&self, robot: usize) -> u32 {
        self.recoveries.get(robot).copied().unwrap_or(0)
    }
}
