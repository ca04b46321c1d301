//! RobotBackend that rapier moves, as a trial sees them.

use envgen::geometry::Pose;
use envgen::glam::DVec2;
use mapping_trial::backend::{Command, Condition, Observation, RobotBackend, Sensors, TICK};
use mapping_trial::lidar::Scan;
use mapping_trial::odometry::Increment;

/// The robots of a trial in rapier: a letter box, into which every tick brings what the robots
/// sensed, for the trial to read.
pub struct RapierRobots {
    ticks: u32,
    /// The robots' sensors, until the robots are spawned with them.
    sensors: Vec<Sensors>,
    /// Seconds that a battery lasts.
    battery: f64,
    robots: Vec<Letter>,
}

/// What became of a robot in the last tick.
#[derive(Clone, Debug)]
pub(super) struct Letter {
    pub(super) pose: Pose,
    pub(super) condition: Condition,
    pub(super) hits: u32,
    pub(super) touching: bool,
    pub(super) odometry: Increment,
    pub(super) scan: Option<Scan>,
    pub(super) water: Option<Vec<DVec2>>,
}

impl RapierRobots {
    pub(super) fn new(starts: &[Pose], battery: f64, sensors: Vec<Sensors>) -> Self {
        let letter = |&pose: &Pose| Letter {
            pose,
            condition: Condition::Operational,
            hits: 0,
            touching: false,
            odometry: Increment::default(),
            scan: None,
            water: None,
        };
        let robots = starts.iter().map(letter).collect();
        RapierRobots { ticks: 0, sensors, battery, robots }
    }

    /// The robots' sensors, to spawn the robots with.
    pub(super) fn take_sensors(&mut self) -> Vec<Sensors> {
        std::mem::take(&mut self.sensors)
    }

    /// Brings what a robot sensed.
    pub(super) fn bring(&mut self, robot: usize, letter: Letter) {
        if let Some(place) = self.robots.get_mut(robot) {
            *place = letter;
        }
    }

    /// A tick has passed.
    pub(super) fn tick(&mut self) {
        self.ticks += 1;
    }

    /// Seconds that every battery still lasts.
    pub(super) fn battery(&self) -> f64 {
        (self.battery - f64::from(self.ticks) * TICK).max(0.0)
    }
}

impl RobotBackend for RapierRobots {
    fn engine(&self) -> &str {
        super::ENGINE
    }

    fn observe(&mut self, robot: usize) -> Observation {
        let battery = self.battery();
        let letter = &mut self.robots[robot];
        Observation {
            time: f64::from(self.ticks) * TICK,
            odometry: letter.odometry,
            scan: letter.scan.take(),
            water: letter.water.take(),
            bumped: letter.touching,
            battery,
        }
    }

    /// Time passes and nothing moves: rapier moves these bodies, in Bevy's schedule.
    fn advance(&mut self, _: &[Command]) {
        self.tick();
        for letter in &mut self.robots {
            letter.odometry = Increment::default();
        }
    }

    fn pose(&self, robot: usize) -> Pose {
        self.robots[robot].pose
    }

    fn condition(&self, robot: usize) -> Condition {
        self.robots[robot].condition
    }

    fn hits(&self, robot: usize) -> u32 {
        self.robots[robot].hits
    }
}
