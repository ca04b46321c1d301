//! Observation in, command out: the same whatever body it drives.

use crate::backend::{Command, Observation};
use crate::lidar::{LaserProfile, Scan};
use crate::map::Estimate;
use crate::policy::{Decision, ExplorationPolicy, PolicyInput};
use crate::robot::Robot;
use crate::slam::Slam;

use envgen::geometry::{Pose, unit_vector};
use glam::DVec2;

/// SLAM and an operator for one or more robots.
///
/// A person takes the operator's half: a brain without an operator makes the map and estimates the
/// poses, and leaves the commands to the caller.
pub struct Autonomy {
    slam: Box<dyn Slam + Send + Sync>,
    operator: Option<Box<dyn ExplorationPolicy + Send + Sync>>,
    body: Robot,
    laser: LaserProfile,
    /// Each robot's last scan, empty before the first.
    scans: Vec<Scan>,
    /// Where each robot last saw water, in the map's frame.
    water: Vec<Vec<DVec2>>,
    /// Each robot's last decision.
    decisions: Vec<Decision>,
    /// Each robot's observations so far.
    ticks: Vec<u64>,
    estimates: Vec<Estimate>,
}

impl Autonomy {
    /// A brain for so many robots of one sort; `operator` is `None` for a person.
    pub fn new(
        slam: Box<dyn Slam + Send + Sync>,
        operator: Option<Box<dyn ExplorationPolicy + Send + Sync>>,
        robots: usize,
        body: &Robot,
        laser: &LaserProfile,
    ) -> Self {
        Autonomy {
            estimates: (0..robots).map(|robot| slam.estimate(robot)).collect(),
            slam,
            operator,
            body: body.clone(),
            laser: laser.clone(),
            scans: vec![Scan { ranges: Vec::new() }; robots],
            water: vec![Vec::new(); robots],
            decisions: vec![Decision::Drive(Command::STOP); robots],
            ticks: vec![0; robots],
        }
    }

    /// Takes in what a robot observes: its pose and the map are estimated again.
    pub fn sense(&mut self, robot: usize, seen: &Observation) {
        self.slam.step(robot, seen);
        if let Some(scan) = &seen.scan {
            self.scans[robot].ranges.clone_from(&scan.ranges);
        }
        self.estimates[robot] = self.slam.estimate(robot);
        if let Some(water) = &seen.water {
            let Pose { position, heading } = self.estimates[robot].pose;
            let ahead = unit_vector(heading);
            self.water[robot].clear();
            self.water[robot].extend(water.iter().map(|&p| position + ahead.rotate(p)));
        }
        self.ticks[robot] += 1;
    }

    /// What the operator wants of a robot now, after [`Autonomy::sense`] of the same observation. A
    /// brain without an operator wants it to stand still.
    pub fn decide(&mut self, robot: usize, seen: &Observation) -> Decision {
        if let Some(operator) = &mut self.operator
            && (self.ticks[robot] + 1).is_multiple_of(operator.ticks_per_decision().max(1))
        {
            self.decisions[robot] = operator.decide(&PolicyInput {
                robot,
                estimates: &self.estimates,
                map: self.slam.map(),
                scan: &self.scans[robot],
                water: &self.water[robot],
                seen,
                body: &self.body,
                laser: &self.laser,
            });
        }
        self.decisions[robot]
    }

    /// The estimates and the map.
    pub fn slam(&self) -> &dyn Slam {
        &*self.slam
    }

    /// The operator; `None` where a person drives.
    pub fn policy(&self) -> Option<&dyn ExplorationPolicy> {
        self.operator.as_deref().map(|operator| operator as &dyn ExplorationPolicy)
    }

    /// A robot's last scan in metres, empty before the first.
    pub fn scan(&self, robot: usize) -> &Scan {
        &self.scans[robot]
    }

    /// How many observations of a robot were taken in.
    pub fn steps(&self, robot: usize) -> u64 {
        self.ticks[robot]
    }
}
