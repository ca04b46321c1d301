//! What passes between a robot's body and its brain.

use envgen::geometry::Pose;
use serde::{Deserialize, Serialize};

use crate::lidar::Scan;
use crate::odometry::Increment;

/// Length of a tick in seconds: bodies move, and commands are logged, 20 times a second.
pub const TICK: f64 = 0.05;

/// What a brain or a person asks of a body for one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Speed ahead in m/s, negative backwards.
    pub speed: f64,
    /// Rate of turning in rad/s, counter-clockwise.
    pub turn_rate: f64,
}

impl Command {
    /// Stand still.
    pub const STOP: Command = Command { speed: 0.0, turn_rate: 0.0 };
}

/// What a body tells its brain after a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Simulated seconds since the start.
    pub time: f64,
    /// What the wheels measured in this tick.
    pub odometry: Increment,
    /// The laser's scan, in the ticks in which one is taken.
    pub scan: Option<Scan>,
    /// Whether the body touches something solid.
    pub bumped: bool,
    /// Seconds that the battery still lasts.
    pub battery: f64,
}

/// What became of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// It drives.
    Able,
    /// It drove into water and is lost.
    Drowned,
}

/// A robot's body in a world: the flat simulator's disc, or anything else that can be driven.
///
/// Each tick a trial calls [`Body::observe`], asks the brain, and calls [`Body::drive`]. The first
/// observation, before the first command, has a scan and no motion.
pub trait Body {
    /// What is measured now. Called once a tick.
    fn observe(&mut self) -> Observation;

    /// Carries out a command for one [`TICK`], within the robot's limits.
    fn drive(&mut self, command: Command);

    /// The true pose, which scores may see and brains may not.
    fn pose(&self) -> Pose;

    /// What became of it so far.
    fn condition(&self) -> Condition;

    /// How many times it has run into something.
    fn hits(&self) -> u32;
}
