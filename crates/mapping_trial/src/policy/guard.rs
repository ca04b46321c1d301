//! Collision avoidance: where the robot can go by the current scan and the camera, without a map.

use envgen::geometry::{Pose, unit_vector};
use glam::DVec2;

use super::margins::outruns;
use crate::lidar::{LaserProfile, Scan};
use crate::robot::Robot;

/// Distance in metres from the laser beyond which echoes do not matter to a slow robot in the next
/// seconds.
const HORIZON: f64 = 3.0;

/// Fraction of the body's radius within which the wheels are. On a walkway through water, the wheels
/// have to stay on the walkway.
const WHEELS: f64 = 0.7;

/// A motion that brings the body at most this much nearer to an echo, in metres, is not stopped by it.
/// In a narrow gap, noise puts echoes beside the body inside it.
const GRAZE: f64 = 0.02;

/// The echoes around a robot, and the water, in its own frame: x ahead, y to the left.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    beams: Vec<DVec2>,
    laser: DVec2,
    /// Whether the robot moves so far between scans that echoes are moved with it.
    outruns: bool,
    horizon: f64,
    radius: f64,
    echoes: Vec<DVec2>,
    water: Vec<DVec2>,
}

impl Guard {
    /// Creates a guard for a robot and its laser.
    pub(super) fn new(robot: &Robot, laser: &LaserProfile) -> Self {
        let mount = robot.laser_pose(Pose::default());
        let beams =
            (0..laser.beams as usize).map(|beam| unit_vector(mount.heading + laser.angle(beam)));
        Guard {
            beams: beams.collect(),
            laser: mount.position,
            outruns: outruns(robot, laser),
            horizon: horizon(robot),
            radius: robot.circumscribed_radius,
            echoes: Vec::new(),
            water: Vec::new(),
        }
    }

    /// Processes a scan, given the robot's present pose relative to its pose at the time of the scan.
    /// Lost and ignored beams are skipped.
    pub(super) fn look(&mut self, scan: &Scan, since: Pose) {
        self.echoes.clear();
        let near = |range: &f64| *range > 0.0 && *range < self.horizon;
        let beams = self.beams.iter().zip(&scan.ranges).filter(|(_, range)| near(range));
        self.echoes.extend(beams.map(|(&beam, &range)| self.laser + beam * range));
        if self.outruns {
            let now = since.world_to_local();
            self.echoes.iter_mut().for_each(|echo| *echo = now(*echo));
        }
    }

    /// Processes the water that was seen last, as points in the map's frame, for a robot at a pose.
    pub(super) fn look_at_water(&mut self, pose: Pose, water: &[DVec2]) {
        let seen = pose.world_to_local();
        self.water.clear();
        self.water.extend(water.iter().copied().map(seen));
    }

    /// What the robot must not touch, each point with the radius to keep free: the whole body for an
    /// echo, the wheels for water.
    fn obstacles(&self) -> impl Iterator<Item = (DVec2, f64)> + '_ {
        let echoes = self.echoes.iter().map(|&echo| (echo, self.radius));
        echoes.chain(self.water.iter().map(|&water| (water, WHEELS * self.radius)))
    }

    /// The echoes of the scan.
    pub(super) fn echoes(&self) -> &[DVec2] {
        &self.echoes
    }

    /// Returns how far in metres the body can drive along an arc of a curvature in 1/m (positive to the
    /// left) before it touches an echo or gets into water; infinite if it does neither.
    pub(super) fn free_along(&self, curvature: f64) -> f64 {
        if curvature.abs() < 0.05 {
            return self.free_towards(DVec2::X);
        }
        let radius = 1.0 / curvature.abs();
        let side = curvature.signum();
        let mut free = f64::INFINITY;
        for (echo, body) in self.obstacles() {
            let (near, far) = (radius - body, radius + body);
            // Relative to the centre of a left-hand circle, counted from where the robot is.
            let from_middle = DVec2::new(echo.x, side * echo.y - radius);
            let distance2 = from_middle.length_squared();
            if distance2 >= far * far || (near > 0.0 && distance2 <= near * near) {
                continue;
            }
            let distance = distance2.sqrt();
            if echo.length() - (distance - radius).abs() < GRAZE {
                continue;
            }
            let at = libm::atan2(from_middle.x, -from_middle.y);
            if at < 0.0 {
                continue;
            }
            let cosine = (radius * radius + distance2 - body * body) / (2.0 * radius * distance);
            let before = libm::acos(cosine.clamp(-1.0, 1.0));
            free = free.min((radius * (at - before)).max(0.0));
        }
        free
    }

    /// Returns the same distance for a straight line along a unit vector of the robot's frame.
    pub(super) fn free_towards(&self, direction: DVec2) -> f64 {
        let mut free = f64::INFINITY;
        for (echo, body) in self.obstacles() {
            let (ahead, beside) = (direction.dot(echo), direction.perp_dot(echo));
            let half2 = body * body - beside * beside;
            if half2 > 0.0 && ahead > 0.0 && echo.length() - beside.abs() >= GRAZE {
                free = free.min((ahead - half2.sqrt()).max(0.0));
            }
        }
        free
    }

    /// Distance in metres between the body and the nearest echo, infinite without one.
    pub(super) fn clearance(&self) -> f64 {
        let nearest = self.echoes.iter().map(|echo| echo.length_squared());
        (nearest.fold(f64::INFINITY, f64::min).sqrt() - self.radius).max(0.0)
    }
}

/// Distance in metres from the laser within which echoes matter: the robot must be able to stop within
/// it.
fn horizon(robot: &Robot) -> f64 {
    let stopping = robot.max_speed * robot.max_speed / (2.0 * robot.acceleration);
    HORIZON.max(stopping + 2.0 * robot.circumscribed_radius + 1.0)
}
