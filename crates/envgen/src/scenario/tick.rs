//! The ticks of a scenario.

/// Number of steps of a scenario per second.
pub const TICKS_PER_SECOND: u64 = 20;

/// Time between two steps in seconds.
pub(super) const TICK: f64 = 1.0 / TICKS_PER_SECOND as f64;
