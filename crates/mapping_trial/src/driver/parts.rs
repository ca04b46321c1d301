//! A driver's parts in a trial: who decides, and where it says so, who estimates.

use envgen::geometry::Pose;

use super::Driver;
use crate::body::Observation;
use crate::map::OccupancyMap;
use crate::operator::Decision;
use crate::slam::motion::{advance, believable};

/// The operator that a driver is.
#[derive(Debug)]
pub struct DriverOperator(Driver);

impl DriverOperator {
    /// The operator of a driver that has been greeted.
    pub fn new(driver: &Driver) -> Self {
        DriverOperator(driver.clone())
    }

    /// scratch
    pub fn ask(
        &mut self,
        robot: usize,
        seen: &Observation,
        pose: Pose,
        map: &OccupancyMap,
    ) -> Option<Decision> {
        let mut session = self.0.session();
        // One that estimates for itself has been asked where its estimate was.
        if !session.has_slam() {
            session.tick(robot, seen, Some((pose, map)));
        }
        session.decision(robot)
    }
}

/// The estimates of a driver that makes them itself. Between its poses, and where it gives none, the
/// wheels are believed.
#[derive(Debug)]
pub struct DriverSlam {
    driver: Driver,
    tracks: Vec<Vec<Pose>>,
    map: OccupancyMap,
}

impl DriverSlam {
    /// The estimates of a driver that has been greeted, for robots that stand at `starts`.
    pub fn new(driver: &Driver, starts: &[Pose]) -> Self {
        DriverSlam {
            driver: driver.clone(),
            tracks: starts.iter().map(|&start| vec![start]).collect(),
            map: OccupancyMap::new(),
        }
    }

    pub(super) fn sense(&mut self, robot: usize, seen: &Observation) {
        let start = self.tracks[0][0].position;
        let track = &mut self.tracks[robot];
        let mut pose = advance(track[track.len() - 1], believable(seen.odometry));
        let mut session = self.driver.session();
        if let Some(said) = session.tick(robot, seen, None) {
            pose = said.pose.unwrap_or(pose);
            match said.map.map(|grid| grid.to_map(start, &self.map)) {
                Some(Ok(map)) => self.map = map,
                Some(Err(error)) => session.fail(&error, seen.time),
                None => {}
            }
        }
        track.push(pose);
    }
}
