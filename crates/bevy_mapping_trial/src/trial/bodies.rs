//! The robot backend of trials in rapier.

use envgen::geometry::Pose;
use envgen::glam::DVec2;
use envgen::scenario::ScenarioState;
use mapping_trial::backend::{Command, Condition, Observation, RobotBackend, Sensors, TICK};
use mapping_trial::lidar::Scan;
use mapping_trial::odometry::Increment;
use mapping_trial::trial::Setup;

/// The name of the robot backend in logs.
pub const ENGINE: &str = "rapier";

/// The robots of a trial in rapier. In every tick, systems store here what the robots have sensed, and the
/// trial reads it.
pub struct RapierRobots {
    ticks: u32,
    /// The sensors of the robots, until they are moved to the spawned robots.
    sensors: Vec<Sensors>,
    /// The operating time of a full battery in seconds.
    battery: f64,
    robots: Vec<TickReport>,
    /// The state of the doors, people and smoke in the last tick.
    scenario: Option<ScenarioState>,
}

/// What a robot has sensed in the last tick.
#[derive(Clone, Debug)]
pub(super) struct TickReport {
    pub(super) pose: Pose,
    pub(super) condition: Condition,
    pub(super) collisions: u32,
    pub(super) person_collisions: u32,
    pub(super) touching: bool,
    pub(super) odometry: Increment,
    pub(super) scan: Option<Scan>,
    pub(super) water: Option<Vec<DVec2>>,
}

impl RapierRobots {
    pub(super) fn new(setup: &Setup<'_>, sensors: Vec<Sensors>) -> Self {
        let report = |&pose: &Pose| TickReport {
            pose,
            condition: Condition::Operational,
            collisions: 0,
            person_collisions: 0,
            touching: false,
            odometry: Increment::default(),
            scan: None,
            water: None,
        };
        let robots = setup.starts.iter().map(report).collect();
        let battery = setup.settings.body.battery;
        RapierRobots { ticks: 0, sensors, battery, robots, scenario: setup.scenario.cloned() }
    }

    /// Returns the sensors of the robots, for spawning the robots.
    pub(super) fn take_sensors(&mut self) -> Vec<Sensors> {
        std::mem::take(&mut self.sensors)
    }

    /// Stores what a robot has sensed.
    pub(super) fn store(&mut self, robot: usize, report: TickReport) {
        if let Some(place) = self.robots.get_mut(robot) {
            *place = report;
        }
    }

    /// Records that a robot no longer exists.
    pub(super) fn remove(&mut self, robot: usize) {
        if let Some(report) = self.robots.get_mut(robot) {
            report.condition = Condition::Removed;
            report.odometry = Increment::default();
        }
    }

    /// Stores the state of the doors, people and smoke.
    pub(super) fn store_scenario(&mut self, state: &ScenarioState) {
        if let Some(scenario) = &mut self.scenario {
            scenario.clone_from(state);
        }
    }

    /// Advances the clock by a tick.
    pub(super) fn tick(&mut self) {
        self.ticks += 1;
    }

    /// Returns the remaining operating time of every battery in seconds.
    pub(super) fn battery(&self) -> f64 {
        (self.battery - f64::from(self.ticks) * TICK).max(0.0)
    }
}

impl RobotBackend for RapierRobots {
    fn engine(&self) -> &str {
        ENGINE
    }

    fn observe(&mut self, robot: usize) -> Observation {
        let battery = self.battery();
        let report = &mut self.robots[robot];
        Observation {
            time: f64::from(self.ticks) * TICK,
            odometry: report.odometry,
            scan: report.scan.take(),
            water: report.water.take(),
            bumped: report.touching,
            battery,
        }
    }

    /// Only advances the time, since rapier moves these robots in Bevy's schedule.
    fn advance(&mut self, _: &[Command]) {
        self.tick();
        for report in &mut self.robots {
            report.odometry = Increment::default();
        }
    }

    fn pose(&self, robot: usize) -> Pose {
        self.robots[robot].pose
    }

    fn condition(&self, robot: usize) -> Condition {
        self.robots[robot].condition
    }

    fn collisions(&self, robot: usize) -> u32 {
        self.robots[robot].collisions
    }

    fn person_collisions(&self, robot: usize) -> u32 {
        self.robots[robot].person_collisions
    }

    fn scenario(&self) -> Option<&ScenarioState> {
        self.scenario.as_ref()
    }
}
