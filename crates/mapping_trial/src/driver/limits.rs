//! Limits on drivers.

use std::time::Duration;

/// Greatest length of a driver's line in bytes, for the largest map that a driver may have.
pub const MAX_LINE: usize = 96 << 20;

/// Limits on the time that a driver may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Limit on the time of one answer.
    pub reply: Duration,
    /// Limit on the total time of all answers in a trial.
    pub total: Duration,
}

impl Default for Limits {
    /// Returns 10 seconds per answer, and one hour for all answers.
    fn default() -> Self {
        Limits { reply: Duration::from_secs(10), total: Duration::from_secs(3600) }
    }
}
