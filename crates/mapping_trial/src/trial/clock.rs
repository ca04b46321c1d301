//! The clock of a trial.

use crate::backend::TICK;

/// The simulated time since the start of a trial, in ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    ticks: u64,
}

impl Clock {
    /// One tick passes.
    pub(super) fn advance(&mut self) {
        self.ticks += 1;
    }

    /// Number of ticks.
    pub(super) fn ticks(self) -> u64 {
        self.ticks
    }

    /// Simulated seconds.
    pub(super) fn time(self) -> f64 {
        self.ticks as f64 * TICK
    }
}
