//! The robots of trials: their size, mass, limits and sensor mounts.

use envgen::difficulty::Platform;
use envgen::geometry::Pose;
use envgen::world::Extent;
use envgen::{SpecError, settings};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use strum::VariantNames;
use thiserror::Error;

use crate::lidar::LaserProfile;
use crate::odometry::OdometryProfile;
use crate::setting_limits::{MAX_TIME_LIMIT, number};

/// The greatest circumscribed radius in metres that robots may have.
pub const MAX_RADIUS: f64 = 2.0;

/// Tolerance in metres by which a circumscribed radius may be less than the body's half diagonal, since
/// data sheets round.
const ROUNDING: f64 = 1e-3;

settings! {
    /// The size, mass and limits of a robot.
    ///
    /// The default is the Pioneer 3-AT, which the operators of Zwennes (2011) drove. `assets/robots`
    /// has other robots.
    ///
    /// ```
    /// use mapping_trial::robot::Robot;
    ///
    /// let robot = Robot { max_speed: 0.4, ..Default::default() };
    /// assert_eq!(robot.validate(), Ok(()));
    /// let small = Robot::from_ron("(length: 0.3, width: 0.3, swing_radius: 0.22, laser_offset: 0.0)")?;
    /// assert_eq!(small.max_speed, Robot::default().max_speed);
    /// # Ok::<(), mapping_trial::robot::RobotError>(())
    /// ```
    pub struct Robot {
        /// Length of the body.
        length: f64 = PIONEER_3AT.length => number("m", 0.01..=2.0 * MAX_RADIUS);
        /// Width of the body.
        width: f64 = PIONEER_3AT.width => number("m", 0.01..=2.0 * MAX_RADIUS);
        /// Height of the robot with everything on it. Solids above this height do not stop it.
        #[serde(skip_serializing_if = "is_usual_height")]
        height: f64 = PIONEER_3AT.height => number("m", 0.01..=10.0);
        /// Radius of the circle that the body sweeps when it turns on the spot: the robot's size for
        /// planning, the flat simulator and the scores. Files call it `swing_radius`.
        #[serde(rename = "swing_radius", alias = "circumscribed_radius")]
        circumscribed_radius: f64 = PIONEER_3AT.circumscribed_radius => number("m", 0.05..=MAX_RADIUS);
        /// Outline seen from above, for physics.
        #[serde(skip_serializing_if = "is_default")]
        footprint: Footprint = PIONEER_3AT.footprint => choice;
        /// Weight and wheels, for physics.
        #[serde(skip_serializing_if = "is_default")]
        chassis: Chassis = PIONEER_3AT.chassis => nested;
        /// Greatest speed, forwards and backwards. It is at most ten circumscribed radii per second, so
        /// that a disc cannot jump over a wall within a tick.
        max_speed: f64 = PIONEER_3AT.max_speed => number("m/s", 0.01..=20.0);
        /// Greatest rate of turning.
        max_turn_rate: f64 = PIONEER_3AT.max_turn_rate => number("rad/s", 0.01..=20.0);
        /// Greatest change of speed.
        acceleration: f64 = PIONEER_3AT.acceleration => number("m/s^2", 0.01..=100.0);
        /// Greatest change of the rate of turning.
        turn_acceleration: f64 = PIONEER_3AT.turn_acceleration => number("rad/s^2", 0.01..=100.0);
        /// Position of the laser ahead of the robot's centre. The laser is on the body.
        laser_offset: f64 = PIONEER_3AT.laser_offset => number("m", -2.0..=MAX_RADIUS);
        /// The rest of the laser's pose.
        #[serde(skip_serializing_if = "is_default")]
        laser_mount: LaserMount = PIONEER_3AT.laser_mount => nested;
        /// Time that the battery lasts.
        battery: f64 = PIONEER_3AT.battery => number("s", 0.05..=MAX_TIME_LIMIT);
        /// Distance to which its camera distinguishes water from floor. Below 0.3, the robot does not see
        /// water and drives into it.
        water_sight: f64 = PIONEER_3AT.water_sight => number("m", 0.0..=5.0);
    }
}

/// The outline of a robot's body, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, VariantNames)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Footprint {
    /// A box of the body's length and width.
    #[default]
    Box,
    /// A disc of the circumscribed radius.
    Disc,
}

settings! {
    /// The mass and the wheels of a robot. The default is the Pioneer 3-AT's.
    #[derive(Copy)]
    pub struct Chassis {
        /// Mass of the robot.
        mass: f64 = PIONEER_3AT.chassis.mass => number("kg", 0.01..=1e5);
        /// Effective track width. That of a skid-steered robot is larger than the distance between its
        /// wheels, which slip sideways when it turns.
        track: f64 = PIONEER_3AT.chassis.track => number("m", 0.01..=4.0 * MAX_RADIUS);
        /// Coefficient of friction between wheels and ground. It limits the force of the wheels: the
        /// larger it is, the less they slip.
        grip: f64 = PIONEER_3AT.chassis.grip => number("", 0.01..=100.0);
    }
}

settings! {
    /// The pose of a laser on a robot, except for its position ahead of the centre.
    #[derive(Copy)]
    pub struct LaserMount {
        /// Position to the left of the robot's centre. The laser is on the body.
        left: f64 = PIONEER_3AT.laser_mount.left => number("m", -2.0..=MAX_RADIUS);
        /// Heading of the laser, counter-clockwise from straight ahead.
        heading: f64 = PIONEER_3AT.laser_mount.heading => number("rad", -6.3..=6.3);
        /// Height of the scan plane above the ground. What ends below it or begins above it is not
        /// seen.
        height: f64 = PIONEER_3AT.laser_mount.height => number("m", 0.0..=10.0);
    }
}

/// The Pioneer 3-AT from its data sheet, which is the default robot.
pub const PIONEER_3AT: Robot = Robot {
    length: 0.508,
    width: 0.497,
    // The body of 0.277 m with the LMS 200 on top.
    height: 0.5,
    circumscribed_radius: 0.355,
    footprint: Footprint::Box,
    chassis: Chassis { mass: 12.0, track: 0.588, grip: 0.6 },
    max_speed: 0.7,
    max_turn_rate: 1.4,
    acceleration: 0.5,
    turn_acceleration: 1.5,
    laser_offset: 0.21,
    laser_mount: LaserMount { left: 0.0, heading: 0.0, height: 0.45 },
    battery: 1200.0,
    water_sight: 1.5,
};

/// Whether a value is that of the Pioneer, which files may omit.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn is_usual_height(value: &f64) -> bool {
    *value == PIONEER_3AT.height
}

/// An error in a text that should describe a robot.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// A syntax error or an unknown field, with its line and column.
    #[error("not the RON of a robot such as `(length: 0.4, width: 0.4)`, at {0}")]
    Ron(#[from] Box<ron::error::SpannedError>),
    /// A number outside of its limits.
    #[error(transparent)]
    Number(#[from] SpecError),
}

impl Robot {
    /// Checks every number.
    ///
    /// # Errors
    ///
    /// Names the first field whose value is not allowed, such as `body.length`.
    pub fn validate(&self) -> Result<(), SpecError> {
        self.check().map_err(|error| error.within("body"))
    }

    fn check(&self) -> Result<(), SpecError> {
        self.check_fields()?;
        let (half, name) = match self.footprint {
            Footprint::Box => (0.5 * libm::hypot(self.length, self.width), "diagonal"),
            Footprint::Disc => (0.5 * self.length.max(self.width), "diameter"),
        };
        let radius = self.circumscribed_radius;
        if radius < half - ROUNDING {
            let allowed = format!("at least {half:.3}, half the {name} of the body");
            return Err(SpecError::new("circumscribed_radius", radius, allowed));
        }
        // Within a tick a disc must not jump over a wall.
        number("max_speed", self.max_speed, 0.01, (10.0 * radius).min(20.0))?;
        // The laser is on the body.
        number("laser_offset", self.laser_offset, -radius, radius)?;
        let left = libm::sqrt(radius * radius - self.laser_offset * self.laser_offset);
        number("laser_mount.left", self.laser_mount.left, -left, left)
    }

    /// Reads a robot from RON, such as `(length: 0.4, width: 0.4, max_speed: 1.2)`. Omitted fields have
    /// the values of the Pioneer.
    ///
    /// ```
    /// use mapping_trial::robot::{PIONEER_3AT, Robot};
    ///
    /// let robot = Robot::from_ron("(max_speed: 0.3, battery: 600)")?;
    /// assert_eq!(robot, Robot { max_speed: 0.3, battery: 600.0, ..PIONEER_3AT });
    /// let error = Robot::from_ron("(width: -1)").unwrap_err();
    /// assert_eq!(error.to_string(), "`body.width` must be a number from 0.01 to 4, got -1");
    /// # Ok::<(), mapping_trial::robot::RobotError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Returns a syntax error, or names the first field whose value is not allowed.
    pub fn from_ron(text: &str) -> Result<Self, RobotError> {
        let robot: Robot = ron::from_str(text).map_err(Box::new)?;
        robot.validate()?;
        Ok(robot)
    }

    /// Returns the extent from the ground to the top of the robot or to the plane of its laser,
    /// whichever is higher. Solids within this extent stop the robot.
    ///
    /// ```
    /// use mapping_trial::robot::{LaserMount, Robot};
    ///
    /// // A low robot with a laser on a mast: what is as high as the laser stops it.
    /// let laser_mount = LaserMount { height: 0.8, ..Default::default() };
    /// let robot = Robot { height: 0.3, laser_mount, ..Default::default() };
    /// let extent = robot.extent()?;
    /// assert_eq!((extent.bottom(), extent.top()), (0.0, 0.8));
    /// # Ok::<(), envgen::SpecError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a height is not valid, as in [`Robot::validate`].
    pub fn extent(&self) -> Result<Extent, SpecError> {
        let of_body = |error: SpecError| error.within("body");
        let top = number("height", self.height, 0.01, 10.0).map(|()| self.height);
        let laser = self.laser_mount.height;
        number("laser_mount.height", laser, 0.0, 10.0).map_err(of_body)?;
        Extent::new(0.0, top.map_err(of_body)?.max(laser)).map_err(of_body)
    }

    /// Returns the pose of the laser of a robot at `pose`, in the same frame.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// use envgen::geometry::Pose;
    /// use envgen::glam::DVec2;
    /// use mapping_trial::robot::Robot;
    ///
    /// // The Pioneer's laser is 0.21 m ahead of its centre; this one looks along +y.
    /// let laser = Robot::default().laser_pose(Pose::new(1.0, 2.0, FRAC_PI_2));
    /// assert!(laser.position.distance(DVec2::new(1.0, 2.21)) < 1e-12);
    /// ```
    pub fn laser_pose(&self, pose: Pose) -> Pose {
        let LaserMount { left, heading, .. } = self.laser_mount;
        let at = DVec2::new(self.laser_offset, left);
        // The heading is not wrapped: wrapping would change the last bits of beams.
        Pose { position: pose.to_world(at), heading: pose.heading + heading }
    }

    /// Returns the platform for difficulty vectors: this robot with its laser and its wheels.
    ///
    /// The standard deviation of a range is at least that of rounding to its steps, which is the step
    /// divided by the root of 12. A platform does not include the laser's position to the side and its
    /// heading, lost, early and mixed echoes, and the errors that are drawn once per run.
    ///
    /// ```
    /// use envgen::difficulty::DifficultyVector;
    /// use envgen::{Blueprint, Seed, Spec, indoor::IndoorSpec};
    /// use mapping_trial::{lidar::LaserProfile, odometry::OdometryProfile, robot::Robot};
    ///
    /// let platform = Robot::default().platform(&LaserProfile::USARSIM, &OdometryProfile::POOR);
    /// assert_eq!((platform.max_range, platform.k_tt), (20.0, 3e-3));
    /// let spec = IndoorSpec { width: 6, height: 6, ..Default::default() };
    /// let world = spec.generate(Seed(7))?.to_world();
    /// assert!(DifficultyVector::of(&world, &platform).is_ok());
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn platform(&self, laser: &LaserProfile, odometry: &OdometryProfile) -> Platform {
        Platform {
            circumscribed_radius: self.circumscribed_radius,
            laser_offset: self.laser_offset,
            beams: laser.beams,
            field_of_view: laser.field_of_view,
            max_range: laser.max_range,
            sigma: laser.sigma.max(laser.range_step / libm::sqrt(12.0)),
            k_ss: odometry.k_ss,
            k_st: odometry.k_st,
            k_tt: odometry.k_tt,
            k_ts: odometry.k_ts,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn robots_are_read_from_ron() {
        let robot = Robot::from_ron("(length: 0.4, max_speed: 1.2)").unwrap();
        assert_eq!(robot, Robot { length: 0.4, max_speed: 1.2, ..Robot::default() });
        let robot = Robot::from_ron("(footprint: disc, chassis: (mass: 3.0))").unwrap();
        assert_eq!(robot.footprint, Footprint::Disc);
        assert_eq!(robot.chassis, Chassis { mass: 3.0, ..PIONEER_3AT.chassis });
        assert_eq!(Robot::from_ron("()"), Ok(Robot::default()));
        let error = |text| Robot::from_ron(text).unwrap_err().to_string();
        assert_eq!(error("(width: -1)"), "`body.width` must be a number from 0.01 to 4, got -1");
        assert!(error("(widht: 1)").contains("widht"), "{}", error("(widht: 1)"));
        assert!(error("(width: ").contains("1:9"), "{}", error("(width: "));
        assert!(
            error("# A robot").starts_with("not the RON of a robot such as `(length: 0.4, width")
        );
    }

    #[test]
    fn numbers_that_fit_no_body_are_named() {
        let error = |text| Robot::from_ron(text).unwrap_err().to_string();
        assert!(
            error("(circumscribed_radius: 0)")
                .contains("`body.circumscribed_radius` must be a number from 0.05")
        );
        assert!(
            error("(circumscribed_radius: 50)").contains("to 2"),
            "{}",
            error("(circumscribed_radius: 50)")
        );
        assert!(
            error("(circumscribed_radius: NaN)").contains("`body.circumscribed_radius` must be")
        );
        let long = error("(length: 1.2)");
        assert!(long.contains("at least 0.649, half the diagonal"), "{long}");
        let wide = error("(width: 0.8, footprint: disc)");
        assert!(wide.contains("at least 0.400, half the diameter"), "{wide}");
        let outside = error("(laser_offset: 0.5)");
        assert!(outside.contains("`body.laser_offset` must be"), "{outside}");
        let outside = error("(laser_offset: 0.3, laser_mount: (left: 0.3))");
        assert!(outside.contains("`body.laser_mount.left` must be"), "{outside}");
        assert!(error("(chassis: (mass: 0))").contains("`body.chassis.mass` must be"));
        assert!(error("(chassis: (track: inf))").contains("`body.chassis.track` must be"));
    }

    #[test]
    fn the_pioneers_new_numbers_are_not_written() {
        let text = ron::to_string(&Robot::default()).expect("RON");
        assert!(!text.contains("chassis") && !text.contains("mount"), "{text}");
        let other = Robot { chassis: Chassis { mass: 3.0, ..Default::default() }, ..PIONEER_3AT };
        let text = ron::to_string(&other).expect("RON");
        assert_eq!(Robot::from_ron(&text), Ok(other), "{text}");
    }

    #[test]
    fn difficulty_vectors_are_for_the_default_robot() {
        let (laser, wheels) = (LaserProfile::default(), OdometryProfile::default());
        assert_eq!(Robot::default().platform(&laser, &wheels), Platform::default());
    }

    #[test]
    fn every_laser_profile_has_a_platform() {
        let wheels = OdometryProfile::EXACT;
        for laser in [LaserProfile::USARSIM, LaserProfile::LMS200_MM, LaserProfile::LMS200_MM_ROUGH]
        {
            assert_eq!(Robot::default().platform(&laser, &wheels).validate(), Ok(()));
        }
        let rounded = Robot::default().platform(&LaserProfile::USARSIM, &wheels);
        assert!((rounded.sigma - 0.01 / 12.0_f64.sqrt()).abs() < 1e-15, "{}", rounded.sigma);
    }

    #[test]
    fn a_laser_sits_where_its_mount_says() {
        let mount = LaserMount { left: 0.1, heading: 1.0, height: 0.2 };
        let robot = Robot { laser_mount: mount, ..PIONEER_3AT };
        let pose = robot.laser_pose(Pose::new(1.0, 2.0, std::f64::consts::FRAC_PI_2));
        assert!(pose.position.distance(glam::DVec2::new(0.9, 2.21)) < 1e-12, "{pose:?}");
        assert!((pose.heading - 1.0 - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
