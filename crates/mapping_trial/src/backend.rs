//! The interface between a robot backend and the robots' autonomy: commands and observations.

use envgen::geometry::Pose;
use envgen::scenario::{DoorCommand, ScenarioState};
use envgen::{Seed, SpecError};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::lidar::{Laser, LaserProfile, LaserSensor, Scan};
use crate::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};

/// Length of a tick in seconds: robots move, and commands are logged, 20 times per second.
pub const TICK: f64 = 0.05;

/// A command to a robot for one tick. NaN and infinite values count as 0.
///
/// ```
/// use mapping_trial::backend::{Command, TICK};
///
/// // An arc to the left with a radius of 1 m, for one tick.
/// let command = Command { speed: 0.5, turn_rate: 0.5 };
/// assert_eq!(command.speed / command.turn_rate, 1.0);
/// assert!((command.speed * TICK - 0.025).abs() < 1e-12);
/// assert_eq!(Command::default(), Command::STOP);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Speed ahead in m/s, negative backwards.
    pub speed: f64,
    /// Rate of turning in rad/s, counter-clockwise.
    pub turn_rate: f64,
}

impl Command {
    /// The command to stop.
    pub const STOP: Command = Command { speed: 0.0, turn_rate: 0.0 };

    /// Returns the command with 0 in place of NaN and infinite values, which no log can hold.
    pub(crate) fn finite(self) -> Command {
        let or_zero = |value: f64| if value.is_finite() { value } else { 0.0 };
        Command { speed: or_zero(self.speed), turn_rate: or_zero(self.turn_rate) }
    }
}

/// What a robot measured in a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// Simulated time since the start, in seconds.
    pub time: f64,
    /// Motion in this tick, as measured by the wheels.
    pub odometry: Increment,
    /// The laser's scan, in ticks that have one.
    pub scan: Option<Scan>,
    /// The water that the robot's camera sees, as returned by [`crate::water::seen`], in ticks that
    /// have a scan; `None` otherwise.
    pub water: Option<Vec<DVec2>>,
    /// Whether the robot touches a solid part, another robot or a person.
    pub bumped: bool,
    /// Seconds until the battery is empty.
    pub battery: f64,
}

/// Whether a robot can still drive, and if not, why.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// It can drive.
    Operational,
    /// It drove into water and can no longer drive.
    Drowned,
    /// It was removed from the simulation.
    Removed,
}

/// A simulator that moves one or more robots in a world and senses for them: the flat simulator or a
/// custom one.
///
/// In each tick a trial calls [`RobotBackend::observe`] for each robot, asks for the commands, and
/// calls [`RobotBackend::advance`] once. The first observation, before the first command, has a scan
/// and no motion.
pub trait RobotBackend {
    /// Returns the name of the backend for logs and reports: `flat`, `rapier`, or a custom name.
    fn engine(&self) -> &str;

    /// Returns what a robot measures now. It is called once per tick for each robot, in order.
    fn observe(&mut self, robot: usize) -> Observation;

    /// Carries out one command per robot for one [`TICK`], within the robots' limits. Drowned and
    /// removed robots stay where they are.
    fn advance(&mut self, commands: &[Command]);

    /// Returns the true pose of a robot in the world's frame. It is for scores, never for SLAM or
    /// policies.
    fn pose(&self, robot: usize) -> Pose;

    /// Returns whether a robot can still drive, and if not, why.
    fn condition(&self, robot: usize) -> Condition;

    /// Returns the number of collisions of a robot so far, without those with people.
    fn collisions(&self, robot: usize) -> u32;

    /// Returns the number of collisions of a robot with people so far.
    fn person_collisions(&self, robot: usize) -> u32 {
        let _ = robot;
        0
    }

    /// Returns the current state of the scenario's doors, people and smoke; `None` if nothing moves.
    fn scenario(&self) -> Option<&ScenarioState> {
        None
    }

    /// Commands a door of the scenario, as [`ScenarioState::command_door`] does.
    ///
    /// Replays need it if the log holds commands to doors. In a backend that does not implement it they
    /// end with an error.
    ///
    /// # Errors
    ///
    /// If there is no such door.
    fn command_door(&mut self, door: usize, command: DoorCommand) -> Result<(), SpecError> {
        let _ = command;
        let engine = self.engine();
        let allowed = format!("the index of a door that the robot backend `{engine}` commands");
        Err(SpecError::new("door", door, allowed))
    }
}

/// The sensors of one robot.
pub struct Sensors {
    /// The laser.
    pub laser: Box<dyn LaserSensor + Send + Sync>,
    /// The wheel encoders.
    pub odometry: Box<dyn WheelSensor + Send + Sync>,
}

impl Sensors {
    /// Creates the built-in sensors of robot number `robot` (from 0). Their noise is drawn from `seed`.
    pub fn new(laser: &LaserProfile, odometry: &OdometryProfile, seed: Seed, robot: u64) -> Self {
        Sensors {
            laser: Box::new(Laser::new(laser.clone(), seed, robot)),
            odometry: Box::new(Odometry::new(odometry.clone(), seed, robot)),
        }
    }
}
