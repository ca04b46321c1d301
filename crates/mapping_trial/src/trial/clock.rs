//! The clock of a trial, which counts ticks of [`TICK`], the time step of every backend. The time limit
//! is a setting, which the trial compares with the time that its backend observes.

use crate::backend::TICK;

/// The simulated time since the start of a trial, in ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    ticks: u64,
}

impl Clock {
    /// Counts one tick.
    pub(super) fn advance(&mut self) {
        self.ticks += 1;
    }

    /// Returns the number of ticks.
    pub(super) fn ticks(self) -> u64 {
        self.ticks
    }

    /// Returns the simulated time in seconds.
    pub(super) fn time(self) -> f64 {
        self.ticks as f64 * TICK
    }
}
