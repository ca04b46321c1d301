//! Detects robots that want to move but do not.

use glam::DVec2;

use crate::backend::Command;

/// The weight of a second of turning on the spot, relative to a second without moving.
const TURNING: f64 = 0.3;

/// How long a robot that wants to move has hardly moved.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// Its position when it last moved.
    at: Option<DVec2>,
    pub(super) stalled: f64,
    time: f64,
    weight: f64,
}

impl Progress {
    /// Records the robot's position, and returns whether it has moved less than a distance for a number
    /// of seconds.
    pub(super) fn is_stuck(&mut self, time: f64, p: DVec2, (least, within): (f64, f64)) -> bool {
        if self.at.is_none_or(|at| at.distance(p) >= least) {
            (self.at, self.stalled) = (Some(p), 0.0);
        }
        // Time between two tasks does not count.
        let passed = (time - self.time).clamp(0.0, 0.2);
        self.stalled += passed * self.weight;
        self.time = time;
        self.stalled >= within
    }

    /// Records the command to the robot: a turn on the spot may take some time.
    pub(super) fn wants(&mut self, command: Command, time: f64) {
        let turns = command.speed == 0.0 && command.turn_rate != 0.0;
        self.weight = if turns { TURNING } else { 1.0 };
        self.time = time;
    }
}
