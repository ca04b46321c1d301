//! Scripted drives through hand-made worlds. They give the measurements of a robot on a path that does
//! not depend on its map, and the estimates from them.

use envgen::geometry::{Pose, Rect, Shape, unit_vector, wrap_angle};
use envgen::glam::DVec2;
use envgen::raycast::Raycaster;
use envgen::world::{Wall, WallKind};
use envgen::{Provenance, Seed, World};
use mapping_trial::backend::{Observation, TICK};
use mapping_trial::lidar::{Laser, LaserProfile, LaserSensor};
use mapping_trial::odometry::{Increment, Odometry, OdometryProfile, WheelSensor};
use mapping_trial::robot::Robot;
use mapping_trial::slam::{Slam, SlamKind, WheelCalibration};

/// Speed in m/s and rate of turning in rad/s.
const PACE: (f64, f64) = (0.5, 0.8);

/// A path through a world with the laser's exact ranges along it.
pub(crate) struct Drive {
    laser: LaserProfile,
    motions: Vec<Increment>,
    /// The tick after which each scan was taken, and its ranges. The first scan is before all motion.
    scans: Vec<(usize, Vec<f64>)>,
    /// The pose at the start and after each motion.
    pub(crate) truth: Vec<Pose>,
}

/// The measurements of a robot, and its true poses.
pub(crate) struct Recording<'a> {
    pub(crate) drive: &'a Drive,
    pub(crate) steps: Vec<Observation>,
}

/// A world of axis-aligned walls.
pub(crate) fn world_of(walls: &[Rect]) -> World {
    let bounds = walls.iter().copied().reduce(Rect::union).expect("walls");
    let mut world = World::new(Provenance::other("manual", serde_json::Value::Null), bounds);
    let wall = |&rect: &Rect| Wall::new(WallKind::Wall, Shape::from_rect(rect));
    world.walls = walls.iter().map(wall).collect();
    assert_eq!(world.check(), Ok(()));
    world
}

pub(crate) fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Rect {
    Rect::new(DVec2::new(x0, y0), DVec2::new(x1, y1))
}

/// Four walls of 0.2 m around a rectangle.
pub(crate) fn frame(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Rect> {
    let t = 0.2;
    vec![
        rect(x0 - t, y0 - t, x1 + t, y0),
        rect(x0 - t, y1, x1 + t, y1 + t),
        rect(x0 - t, y0, x0, y1),
        rect(x1, y0, x1 + t, y1),
    ]
}

impl Drive {
    /// Drives from waypoint to waypoint: the robot turns on the spot if the next one is far off its
    /// heading, otherwise it drives and steers.
    pub(crate) fn new(world: &World, waypoints: &[DVec2], laser: &LaserProfile) -> Self {
        let rays = Raycaster::new(world);
        let robot = Robot::default();
        let fan = laser.fan().expect("a laser");
        let cast = |pose: Pose| {
            let mut ranges = Vec::new();
            rays.scan(robot.laser_pose(pose), &fan, laser.max_range, &mut ranges);
            ranges
        };
        let heading = heading_of(waypoints[1] - waypoints[0]);
        let mut pose = Pose { position: waypoints[0], heading };
        let (mut motions, mut truth) = (vec![Increment::default()], vec![pose, pose]);
        let mut scans = vec![(0, cast(pose))];
        for &target in &waypoints[1..] {
            while pose.position.distance(target) > 0.05 {
                let off = wrap_angle(heading_of(target - pose.position) - pose.heading);
                let most = PACE.1 * TICK;
                let turn = off.clamp(-most, most);
                let distance = if off.abs() > 0.3 { 0.0 } else { PACE.0 * TICK };
                pose.position += unit_vector(pose.heading + 0.5 * turn) * distance;
                pose.heading = wrap_angle(pose.heading + turn);
                if motions.len().is_multiple_of(laser.ticks_a_scan as usize) {
                    scans.push((motions.len(), cast(pose)));
                }
                motions.push(Increment { distance, turn });
                truth.push(pose);
            }
        }
        Drive { laser: laser.clone(), motions, scans, truth }
    }

    /// Returns the measurements of a robot on the path.
    pub(crate) fn record(&self, odometry: &OdometryProfile, seed: u64) -> Recording<'_> {
        let mut wheels = Odometry::new(odometry.clone(), Seed(seed), 0);
        let mut sensor = Laser::new(self.laser.clone(), Seed(seed), 0);
        let measured = self.motions.iter().map(|&motion| Observation {
            odometry: wheels.measure(motion, 1.0),
            ..Observation::default()
        });
        let mut steps: Vec<Observation> = measured.collect();
        for (tick, exact) in &self.scans {
            steps[*tick].scan = Some(sensor.measure(exact));
        }
        Recording { drive: self, steps }
    }
}

/// The heading of a vector.
fn heading_of(v: DVec2) -> f64 {
    libm::atan2(v.y, v.x)
}

impl Recording<'_> {
    /// Replays the measurements with an estimator.
    pub(crate) fn replay(&self, kind: SlamKind) -> Box<dyn Slam + Send> {
        self.replay_with(kind, WheelCalibration::default())
    }

    /// Replays the measurements with an estimator that learns certain errors of the wheels.
    pub(crate) fn replay_with(
        &self,
        kind: SlamKind,
        calibration: WheelCalibration,
    ) -> Box<dyn Slam + Send> {
        let start = &self.drive.truth[..1];
        let mut slam = kind.build(start, &Robot::default(), &self.drive.laser, calibration);
        for seen in &self.steps {
            slam.step(0, seen);
        }
        slam
    }
}
