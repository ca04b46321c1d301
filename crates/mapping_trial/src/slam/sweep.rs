//! Scans as points around the robot.

use envgen::geometry::{Pose, unit_vector};
use glam::{DVec2, Vec2};

use crate::lidar::{LaserProfile, NO_ECHO, Scan};
use crate::robot::Robot;

/// Greatest distance in metres at which a ray changes the map, which bounds the memory of one scan.
/// Echoes from farther away are ignored.
pub const REACH: f64 = 40.0;

/// Least number of echoes by which a place can be recognised.
pub const FEWEST_ECHOES: usize = 10;

/// Greatest number of echoes that are kept. Of finer lasers, only every second, third, ... beam counts.
const MOST_BEAMS: usize = 2048;

/// The echoes of one scan, in metres in the robot's own frame (x ahead).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweep {
    /// End points of the rays with an echo.
    pub echoes: Vec<Vec2>,
    /// End points of the rays without an echo.
    pub clear: Vec<Vec2>,
}

impl Sweep {
    /// Returns the distance of the farthest point from the robot's centre, in metres.
    pub fn radius(&self) -> f64 {
        let farthest = |points: &[Vec2]| points.iter().fold(0.0_f32, |r, p| r.max(p.length()));
        f64::from(farthest(&self.echoes).max(farthest(&self.clear)))
    }
}

/// Turns the scans of one kind of laser on one kind of robot into points.
#[derive(Clone, Debug)]
pub struct Sweeper {
    directions: Vec<DVec2>,
    stride: usize,
    max_range: f64,
    laser: Pose,
}

impl Sweeper {
    /// Creates a sweeper for the laser of a robot.
    pub fn new(robot: &Robot, laser: &LaserProfile) -> Self {
        let beams = laser.beams as usize;
        let stride = beams.div_ceil(MOST_BEAMS).max(1);
        let mount = robot.laser_pose(Pose::default());
        let within = |at: f64| if at.is_finite() { at.clamp(-REACH, REACH) } else { 0.0 };
        Sweeper {
            directions: (0..beams)
                .step_by(stride)
                .map(|i| unit_vector(mount.heading + laser.angle(i)))
                .collect(),
            stride,
            max_range: if laser.max_range > 0.0 { laser.max_range.min(REACH) } else { 0.0 },
            laser: Pose::new(within(mount.position.x), within(mount.position.y), mount.heading),
        }
    }

    /// Returns the laser's pose in the robot's frame.
    pub fn laser(&self) -> Pose {
        self.laser
    }

    /// Returns the points of a scan. It ignores ranges that are NaN, negative or 0 (which a Hokuyo
    /// gives for an error), and those beyond the laser's number of beams.
    ///
    /// ```
    /// use envgen::glam::Vec2;
    /// use mapping_trial::lidar::{LaserProfile, NO_ECHO, Scan};
    /// use mapping_trial::{robot::Robot, slam::sweep::Sweeper};
    ///
    /// // Beams to the right, ahead and to the left, from 0.21 m ahead of the robot's centre.
    /// let laser = LaserProfile { beams: 3, ..LaserProfile::LMS200_MM };
    /// let sweeper = Sweeper::new(&Robot::default(), &laser);
    /// let sweep = sweeper.sweep(&Scan { ranges: vec![2.0, NO_ECHO, f64::NAN] });
    /// assert!(sweep.echoes[0].distance(Vec2::new(0.21, -2.0)) < 1e-6);
    /// // Without an echo the beam is clear up to the greatest range.
    /// assert!(sweep.clear[0].distance(Vec2::new(0.21 + 8.19, 0.0)) < 1e-6);
    /// ```
    pub fn sweep(&self, scan: &Scan) -> Sweep {
        let mut sweep = Sweep::default();
        let ranges = scan.ranges.iter().step_by(self.stride);
        for (&range, &direction) in ranges.zip(&self.directions) {
            let point = |r: f64| (self.laser.position + direction * r).as_vec2();
            if range == NO_ECHO || range > self.max_range {
                sweep.clear.push(point(self.max_range));
            } else if range > 0.0 {
                sweep.echoes.push(point(range));
            }
        }
        sweep
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn points_are_at_the_echoes_of_the_beams() {
        let laser = LaserProfile { beams: 3, ..LaserProfile::LMS200_MM };
        let sweeper = Sweeper::new(&Robot::default(), &laser);
        let sweep = sweeper.sweep(&Scan { ranges: vec![2.0, NO_ECHO, f64::NAN] });
        assert_eq!(sweep.echoes.len(), 1);
        assert!(sweep.echoes[0].distance(Vec2::new(0.21, -2.0)) < 1e-6);
        assert_eq!(sweep.clear.len(), 1);
        assert!(sweep.clear[0].distance(Vec2::new(0.21 + 8.19, 0.0)) < 1e-6);
    }

    proptest! {
        #[test]
        fn any_ranges_give_finite_points(
            ranges in proptest::collection::vec(any::<f64>(), 0..400),
            max_range in any::<f64>(), laser_offset in any::<f64>(), beams in 0..5000_u32,
        ) {
            let laser = LaserProfile { max_range, beams, ..LaserProfile::default() };
            let robot = Robot { laser_offset, ..Robot::default() };
            let sweep = Sweeper::new(&robot, &laser).sweep(&Scan { ranges });
            prop_assert!(sweep.radius() <= 2.0 * REACH + 1e-3);
            prop_assert!(sweep.echoes.len() + sweep.clear.len() <= MOST_BEAMS);
        }
    }
}
