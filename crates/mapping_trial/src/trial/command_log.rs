//! The commands in a log.

use serde::{Deserialize, Serialize};

use crate::backend::Command;

/// The commands of one robot, in runs of equal ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct CommandLog {
    /// Speed in m/s, rate of turning in rad/s, and the number of ticks of a run.
    runs: Vec<(f64, f64, u64)>,
}

impl CommandLog {
    pub(super) fn push(&mut self, command: Command) {
        let Command { speed, turn_rate } = command;
        match self.runs.last_mut() {
            Some((s, t, ticks))
                if s.to_bits() == speed.to_bits() && t.to_bits() == turn_rate.to_bits() =>
            {
                *ticks += 1;
            }
            _ => self.runs.push((speed, turn_rate, 1)),
        }
    }

    pub(super) fn ticks(&self) -> u64 {
        self.runs.iter().fold(0, |sum, run| sum.saturating_add(run.2))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Command> + '_ {
        self.runs.iter().flat_map(|&(speed, turn_rate, ticks)| {
            (0..ticks).map(move |_| Command { speed, turn_rate })
        })
    }
}
