//! What a driver is limited to.

use std::time::Duration;

/// Bytes in a driver's line, at most.
pub const MAX_LINE: usize = 16 << 20;

/// How long a driver may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// For one answer.
    pub reply: Duration,
    /// For all answers of a trial together.
    pub total: Duration,
}

impl Default for Limits {
    /// 10 seconds per answer, one hour for all answers.
    fn default() -> Self {
        Limits { reply: Duration::from_secs(10), total: Duration::from_secs(3600) }
    }
}
