//! Limits on drivers.

use std::time::Duration;

/// Greatest length of a driver's line in bytes.
pub const MAX_LINE: usize = 16 << 20;

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
