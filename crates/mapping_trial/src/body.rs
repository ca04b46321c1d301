//! What passes between a robot's body and its brain.

use envgen::geometry::Pose;
use glam::DVec2;
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
    /// What its camera shows to be water, as [`crate::water::seen`] gives it, in the ticks of scans;
    /// `None` between them.
    pub water: Option<Vec<DVec2>>,
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

/// The bodies of one or more robots in a world: the flat simulator's discs, or anything else that
/// can be driven.
///
/// Each tick a trial calls [`Bodies::observe`] for each robot, asks the brain, and calls
/// [`Bodies::advance`] once. The first observation, before the first command, has a scan and no
/// motion.
pub trait Bodies {
    /// What a robot measures now. Called once a tick for each robot, in order.
    fn observe(&mut self, robot: usize) -> Observation;

    /// Carries out one command a robot for one [`TICK`], within the robots' limits. Robots that are
    /// lost stay where they are.
    fn advance(&mut self, commands: &[Command]);

    /// The true pose of a robot, which scores may see and brains may not.
    fn pose(&self, robot: usize) -> Pose;

    /// What became of a robot so far.
    fn condition(&self, robot: usize) -> Condition;

    /// How many times a robot has run into something.
    fn hits(&self, robot: usize) -> u32;
}
