//! The parts of a driver in a trial: the policy and, if the driver provides it, SLAM.

use std::sync::OnceLock;

use envgen::geometry::Pose;

use super::connection::Driver;
use crate::backend::Observation;
use crate::map::{Estimate, OccupancyMap};
use crate::policy::{Decision, ExplorationPolicy, PolicyInput};
use crate::slam::Slam;
use crate::slam::motion::{advance, believable};
use crate::trial::TrialParts;

impl Driver {
    /// Returns the trial parts that the driver provides: the policy and, if its hello says so, SLAM.
    /// [`Driver::greet`] must come first.
    pub fn parts(&self) -> TrialParts {
        let driver = self.clone();
        let parts = TrialParts::default().policy(move |_| DriverPolicy::new(&driver));
        if !self.session().has_slam() {
            return parts;
        }
        let driver = self.clone();
        parts.slam(move |setup| DriverSlam::new(&driver, setup.starts))
    }
}

/// The name of a driver's parts in logs and reports.
fn name(driver: &Driver) -> String {
    driver.session().name().map_or("driver".to_owned(), |name| format!("driver {name}"))
}

/// The policy of a driver.
#[derive(Debug)]
pub struct DriverPolicy {
    driver: Driver,
    name: String,
    failure: OnceLock<String>,
}

impl DriverPolicy {
    /// Creates the policy of a driver that has answered the hello.
    pub fn new(driver: &Driver) -> Self {
        DriverPolicy { driver: driver.clone(), name: name(driver), failure: OnceLock::new() }
    }
}

impl ExplorationPolicy for DriverPolicy {
    fn name(&self) -> &str {
        &self.name
    }

    /// Returns 1: the session asks the driver every tick, or as rarely as its hello requests.
    fn ticks_per_decision(&self) -> u64 {
        1
    }

    fn decide(&mut self, view: &PolicyInput<'_>) -> Decision {
        let robot = view.robot;
        let mut session = self.driver.session();
        // A driver with SLAM was already asked for the estimate.
        if !session.has_slam() {
            session.tick(robot, view.seen, Some((view.estimates[robot].pose, view.map)));
        }
        session.decision(robot).unwrap_or(Decision::Failed)
    }

    fn failure(&self) -> Option<&str> {
        // A driver with SLAM may also fail in a tick without a decision: the last one of a robot.
        if let Some(reason) = self.driver.session().failure() {
            self.failure.get_or_init(|| reason.to_owned());
        }
        self.failure.get().map(String::as_str)
    }
}

/// The SLAM of a driver. Between its poses, and where it gives none, poses come from wheel odometry.
#[derive(Debug)]
pub struct DriverSlam {
    driver: Driver,
    name: String,
    tracks: Vec<Vec<Pose>>,
    map: OccupancyMap,
}

impl DriverSlam {
    /// Creates the SLAM of a driver that has answered the hello, for robots at the poses `starts`.
    pub fn new(driver: &Driver, starts: &[Pose]) -> Self {
        DriverSlam {
            driver: driver.clone(),
            name: name(driver),
            tracks: starts.iter().map(|&start| vec![start]).collect(),
            map: OccupancyMap::new(),
        }
    }

    fn pose(&self, robot: usize) -> Pose {
        let track = &self.tracks[robot];
        track[track.len() - 1]
    }
}

impl Slam for DriverSlam {
    fn name(&self) -> &str {
        &self.name
    }

    fn step(&mut self, robot: usize, seen: &Observation) {
        let mut pose = advance(self.pose(robot), believable(seen.odometry));
        let mut session = self.driver.session();
        if let Some(said) = session.tick(robot, seen, None) {
            pose = said.pose.unwrap_or(pose);
            let start = self.tracks[0][0].position;
            match said.map.map(|grid| grid.to_map(start)) {
                Some(Ok(map)) => self.map.replace(map),
                Some(Err(error)) => session.fail(&error, seen.time),
                None => {}
            }
        }
        self.tracks[robot].push(pose);
    }

    fn estimate(&self, robot: usize) -> Estimate {
        Estimate { pose: self.pose(robot), ..Estimate::default() }
    }

    fn map(&self) -> &OccupancyMap {
        &self.map
    }

    fn trajectory(&self, robot: usize) -> Vec<Pose> {
        self.tracks[robot].clone()
    }
}
