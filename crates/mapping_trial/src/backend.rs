//! What passes between a robot's body and its autonomy.

use envgen::Seed;
use envgen::geometry::Pose;
use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::lidar::{Laser, LaserProfile, LaserSensor, Scan};
use crate::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};

/// Length of a tick in seconds: bodies move, and commands are logged, 20 times a second.
pub const TICK: f64 = 0.05;

/// What a brain or a person asks of a body for one tick. NaN and infinite values count as 0.
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

    /// The same with 0 in place of NaN and infinities, which no log can hold.
    pub(crate) fn finite(self) -> Command {
        let or_zero = |value: f64| if value.is_finite() { value } else { 0.0 };
        Command { speed: or_zero(self.speed), turn_rate: or_zero(self.turn_rate) }
    }
}

/// What a body tells its brain after a tick.
#[derive(Clone, Debug, Default, PartialEq)]
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
    Operational,
    /// It drove into water and is lost.
    Drowned,
}

/// The bodies of one or more robots in a world: the flat simulator's discs, or anything else that
/// can be driven.
///
/// Each tick a trial calls [`RobotBackend::observe`] for each robot, asks the brain, and calls
/// [`RobotBackend::advance`] once. The first observation, before the first command, has a scan and no
/// motion.
pub trait RobotBackend {
    /// What moves these bodies, as logs and reports name it: `flat`, `rapier`, or a name of one's own.
    fn engine(&self) -> &str;

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

/// What one robot measures with.
pub struct Sensors {
    /// The laser.
    pub laser: Box<dyn LaserSensor + Send + Sync>,
    /// The wheels.
    pub odometry: Box<dyn WheelSensor + Send + Sync>,
}

impl Sensors {
    /// The built-in ones of the robot of number `robot` in the run of a seed.
    pub fn new(laser: &LaserProfile, odometry: &OdometryProfile, seed: Seed, robot: u64) -> Self {
        Sensors {
            laser: Box::new(Laser::new(laser.clone(), seed, robot)),
            odometry: Box::new(Odometry::new(odometry.clone(), seed, robot)),
        }
    }
}
