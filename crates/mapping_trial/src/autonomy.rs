//! The robots' autonomy, which turns observations into commands. It is the same for every robot
//! backend.

use crate::backend::{Command, Observation};
use crate::lidar::{LaserProfile, Scan};
use crate::map::Estimate;
use crate::policy::{Decision, ExplorationPolicy, PolicyInput};
use crate::robot::Robot;
use crate::slam::Slam;
use crate::slam::motion::{advance, believable};

use envgen::geometry::{Pose, Rect};
use glam::DVec2;

/// SLAM and an exploration policy for one or more robots.
///
/// If a person drives, there is no policy: the autonomy then makes the map and estimates the poses, and
/// leaves the commands to the caller.
///
/// ```
/// use envgen::geometry::{Pose, Rect};
/// use envgen::glam::DVec2;
/// use mapping_trial::backend::{Command, Observation};
/// use mapping_trial::odometry::Increment;
/// use mapping_trial::policy::Decision;
/// use mapping_trial::{autonomy::Autonomy, lidar::LaserProfile, robot::Robot};
/// use mapping_trial::slam::{SlamKind, WheelCalibration};
///
/// let (robot, laser) = (Robot::default(), LaserProfile::default());
/// let slam = SlamKind::DeadReckoning.build(
///     &[Pose::default()], &robot, &laser, WheelCalibration::default(),
/// );
/// let area = Rect::new(DVec2::splat(-5.0), DVec2::splat(5.0));
/// let mut autonomy = Autonomy::new(slam, None, 1, &robot, &laser, area);
/// // Ten ticks of 3 cm ahead, without a scan.
/// let odometry = Increment { distance: 0.03, turn: 0.0 };
/// let seen = Observation { odometry, ..Default::default() };
/// (0..10).for_each(|_| autonomy.sense(0, &seen));
/// assert!((autonomy.slam().estimate(0).pose.position.x - 0.3).abs() < 1e-9);
/// // Without a policy the caller drives.
/// assert_eq!(autonomy.decide(0, &seen), Decision::Drive(Command::STOP));
/// ```
pub struct Autonomy {
    slam: Box<dyn Slam + Send + Sync>,
    policy: Option<Box<dyn ExplorationPolicy + Send + Sync>>,
    body: Robot,
    laser: LaserProfile,
    area: Rect,
    doors: bool,
    /// Each robot's last scan, empty before the first.
    scans: Vec<Scan>,
    /// Each robot's motion since then.
    since_scan: Vec<Pose>,
    /// Where each robot last saw water, in the map's frame.
    water: Vec<Vec<DVec2>>,
    /// Each robot's last decision.
    decisions: Vec<Decision>,
    /// Number of each robot's observations so far.
    ticks: Vec<u64>,
    estimates: Vec<Estimate>,
}

impl Autonomy {
    /// Creates the autonomy of a number of equal robots that map an area. `policy` is `None` if a
    /// person drives.
    pub fn new(
        slam: Box<dyn Slam + Send + Sync>,
        policy: Option<Box<dyn ExplorationPolicy + Send + Sync>>,
        robots: usize,
        body: &Robot,
        laser: &LaserProfile,
        area: Rect,
    ) -> Self {
        Autonomy {
            estimates: (0..robots).map(|robot| slam.estimate(robot)).collect(),
            slam,
            policy,
            body: body.clone(),
            laser: laser.clone(),
            area,
            doors: false,
            scans: vec![Scan { ranges: Vec::new() }; robots],
            since_scan: vec![Pose::default(); robots],
            water: vec![Vec::new(); robots],
            decisions: vec![Decision::Drive(Command::STOP); robots],
            ticks: vec![0; robots],
        }
    }

    /// Tells the policy whether there are doors that open and close ([`PolicyInput::doors`]); by default there
    /// are none.
    #[must_use]
    pub fn with_doors(mut self, doors: bool) -> Self {
        self.doors = doors;
        self
    }

    /// Processes an observation of a robot: updates its pose estimate and the map.
    pub fn sense(&mut self, robot: usize, seen: &Observation) {
        self.slam.step(robot, seen);
        self.since_scan[robot] = advance(self.since_scan[robot], believable(seen.odometry));
        if let Some(scan) = &seen.scan {
            self.scans[robot].ranges.clone_from(&scan.ranges);
            self.since_scan[robot] = Pose::default();
        }
        self.estimates[robot] = self.slam.estimate(robot);
        if let Some(water) = &seen.water {
            let on_map = self.estimates[robot].pose.local_to_world();
            self.water[robot].clear();
            self.water[robot].extend(water.iter().copied().map(on_map));
        }
        self.ticks[robot] += 1;
    }

    /// Returns the policy's decision for a robot, after [`Autonomy::sense`] with the same observation.
    /// Without a policy the robot stops.
    pub fn decide(&mut self, robot: usize, seen: &Observation) -> Decision {
        if let Some(policy) = &mut self.policy
            && is_due(self.ticks[robot], policy.ticks_per_decision())
        {
            self.decisions[robot] = policy.decide(&PolicyInput {
                robot,
                estimates: &self.estimates,
                map: self.slam.map(),
                scan: &self.scans[robot],
                since_scan: self.since_scan[robot],
                water: &self.water[robot],
                seen,
                body: &self.body,
                laser: &self.laser,
                area: self.area,
                doors: self.doors,
            });
        }
        self.decisions[robot]
    }

    /// Returns the SLAM estimator, with the pose estimates and the map.
    pub fn slam(&self) -> &dyn Slam {
        &*self.slam
    }

    /// Returns the policy; `None` if a person drives.
    pub fn policy(&self) -> Option<&dyn ExplorationPolicy> {
        self.policy.as_deref().map(|policy| policy as &dyn ExplorationPolicy)
    }

    /// Returns a robot's last scan in metres, which is empty before the first.
    pub fn scan(&self, robot: usize) -> &Scan {
        &self.scans[robot]
    }

    /// Returns the number of observations of a robot so far.
    pub fn steps(&self, robot: usize) -> u64 {
        self.ticks[robot]
    }
}

/// Whether a policy is asked in a tick, counted from 1: in the first, and then every `interval` ticks.
fn is_due(tick: u64, interval: u64) -> bool {
    let interval = interval.max(1);
    tick % interval == 1 % interval
}

#[cfg(test)]
mod tests {
    use super::is_due;

    #[test]
    fn the_first_decision_is_in_the_first_tick() {
        for (interval, expected) in
            [(0, [1, 2, 3]), (1, [1, 2, 3]), (2, [1, 3, 5]), (20, [1, 21, 41])]
        {
            let asked = (1..).filter(|&tick| is_due(tick, interval)).take(3);
            assert!(asked.eq(expected), "every {interval} ticks");
        }
    }
}
