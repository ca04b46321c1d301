//! What the current scan says about where the robot can go, without any map.

use envgen::geometry::unit_vector;
use glam::DVec2;

use crate::lidar::{LaserProfile, Scan};
use crate::robot::Robot;

/// Echoes farther than this many metres from the laser matter to no motion of the next seconds.
const HORIZON: f64 = 3.0;

/// The echoes around a robot, in its own frame: x ahead, y to the left.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    beams: Vec<DVec2>,
    laser: DVec2,
    radius: f64,
    echoes: Vec<DVec2>,
}

impl Guard {
    /// For a robot and its laser.
    pub(super) fn new(robot: &Robot, laser: &LaserProfile) -> Self {
        Guard {
            beams: (0..laser.beams as usize).map(|beam| unit_vector(laser.angle(beam))).collect(),
            laser: DVec2::new(robot.laser_offset, 0.0),
            radius: robot.swing_radius,
            echoes: Vec::new(),
        }
    }

    /// Takes a scan; lost and ignored beams say nothing.
    pub(super) fn look(&mut self, scan: &Scan) {
        self.echoes.clear();
        let near = |range: &f64| *range > 0.0 && *range < HORIZON;
        let beams = self.beams.iter().zip(&scan.ranges).filter(|(_, range)| near(range));
        self.echoes.extend(beams.map(|(&beam, &range)| self.laser + beam * range));
    }

    /// The echoes taken.
    pub(super) fn echoes(&self) -> &[DVec2] {
        &self.echoes
    }

    /// Metres that the body can go along an arc of a curvature in 1/m (left positive) before it
    /// touches an echo, infinite when it touches none.
    pub(super) fn free_along(&self, curvature: f64) -> f64 {
        if curvature.abs() < 0.05 {
            return self.free_towards(DVec2::X);
        }
        let radius = 1.0 / curvature.abs();
        let side = curvature.signum();
        let (near, far) = (radius - self.radius, radius + self.radius);
        let mut free = f64::INFINITY;
        for &echo in &self.echoes {
            // Around the middle of a left-hand circle, counted from where the robot is.
            let from_middle = DVec2::new(echo.x, side * echo.y - radius);
            let distance2 = from_middle.length_squared();
            if distance2 >= far * far || (near > 0.0 && distance2 <= near * near) {
                continue;
            }
            let distance = distance2.sqrt();
            let at = libm::atan2(from_middle.x, -from_middle.y);
            if at < 0.0 {
                continue;
            }
            let body2 = self.radius * self.radius;
            let cosine = (radius * radius + distance2 - body2) / (2.0 * radius * distance);
            let before = libm::acos(cosine.clamp(-1.0, 1.0));
            free = free.min((radius * (at - before)).max(0.0));
        }
        free
    }

    /// The same on the straight line along a unit vector of the robot's frame.
    pub(super) fn free_towards(&self, direction: DVec2) -> f64 {
        let body2 = self.radius * self.radius;
        let mut free = f64::INFINITY;
        for &echo in &self.echoes {
            let (ahead, beside) = (direction.dot(echo), direction.perp_dot(echo));
            let half2 = body2 - beside * beside;
            if half2 > 0.0 && ahead > 0.0 {
                free = free.min((ahead - half2.sqrt()).max(0.0));
            }
        }
        free
    }

    /// Metres between the body and the nearest echo, infinite when there is none.
    pub(super) fn clearance(&self) -> f64 {
        let nearest = self.echoes.iter().map(|echo| echo.length_squared());
        (nearest.fold(f64::INFINITY, f64::min).sqrt() - self.radius).max(0.0)
    }
}
