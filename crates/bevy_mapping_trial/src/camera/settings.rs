//! The settings of the camera of a robot.

use bevy::prelude::*;
use mapping_trial::robot::Robot;
use thiserror::Error;

/// The largest number of pixels along a side of a picture.
pub const MAX_PIXELS: u32 = 4096;

/// The distances in metres at which [`RobotCamera::on`] places a camera behind the front of a robot and above
/// its top.
const BEHIND_FRONT: f64 = 0.05;
const ABOVE_TOP: f64 = 0.08;

/// The allowed horizontal fields of view in degrees.
const FIELDS_OF_VIEW: std::ops::RangeInclusive<f64> = 1.0..=170.0;

/// The largest distance in metres between the centre of a robot and its camera, on each axis.
const MAX_OFFSET: f64 = 10.0;

/// The allowed numbers of pictures per simulated second.
const RATES: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// A component that gives a robot a camera. Add it to an entity with a
/// [`RobotModel`](crate::robot::RobotModel). To change it, insert another.
///
/// Lengths are in metres and angles in degrees. The default is a small camera on the front of a Pioneer 3-AT
/// that looks ahead.
///
/// ```
/// use bevy_mapping_trial::camera::RobotCamera;
///
/// let camera = RobotCamera { width: 640, height: 480, pitch: -10.0, ..Default::default() };
/// assert_eq!(camera.check(), Ok(()));
/// let wrong = RobotCamera { field_of_view: 180.0, ..Default::default() };
/// assert_eq!(
///     wrong.check().unwrap_err().to_string(),
///     "`field_of_view` of a camera must be a number of degrees from 1 to 170, got 180"
/// );
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[component(immutable)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct RobotCamera {
    /// The distance in front of the robot's centre, from -10 to 10 m.
    pub forward: f64,
    /// The distance to the left of the robot's centre, from -10 to 10 m.
    pub left: f64,
    /// The height above the floor, from -10 to 10 m.
    pub up: f64,
    /// The tilt of the optical axis, positive upwards, from -90 to 90 degrees.
    pub pitch: f64,
    /// The rotation of the optical axis to the left of the robot's heading, from -180 to 180 degrees.
    pub yaw: f64,
    /// The horizontal field of view, from 1 to 170 degrees. Pixels are square.
    pub field_of_view: f64,
    /// The number of pixels from left to right, from 1 to [`MAX_PIXELS`].
    pub width: u32,
    /// The number of pixels from top to bottom, from 1 to [`MAX_PIXELS`].
    pub height: u32,
    /// The number of pictures per simulated second, from 0.001 to 1000. At most one picture is taken in each
    /// frame of the app.
    pub rate: f64,
    /// The images that are taken.
    pub images: CameraImages,
}

impl Default for RobotCamera {
    fn default() -> Self {
        RobotCamera {
            forward: 0.2,
            left: 0.0,
            up: 0.55,
            pitch: 0.0,
            yaw: 0.0,
            field_of_view: 70.0,
            width: 320,
            height: 240,
            rate: 2.0,
            images: CameraImages::default(),
        }
    }
}

impl RobotCamera {
    /// Returns the default camera, placed at the front of a robot, above its body and its laser.
    ///
    /// ```
    /// use bevy_mapping_trial::camera::RobotCamera;
    /// use mapping_trial::robot::Robot;
    ///
    /// let low = Robot { height: 0.2, ..Robot::default() };
    /// assert!(RobotCamera::on(&low).up < RobotCamera::on(&Robot { height: 0.9, ..low }).up);
    /// ```
    pub fn on(robot: &Robot) -> Self {
        RobotCamera {
            forward: 0.5 * robot.length - BEHIND_FRONT,
            up: robot.height.max(robot.laser_mount.height) + ABOVE_TOP,
            ..RobotCamera::default()
        }
    }
}

/// The images that a camera takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, PartialEq, Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct CameraImages {
    /// Whether it takes colour images, which a [`Camera3d`] draws.
    pub color: bool,
    /// Whether it takes depth images, with the distance of each pixel along the optical axis.
    pub depth: bool,
    /// Whether it takes label images, with the label of the surface at each pixel.
    pub labels: bool,
}

impl Default for CameraImages {
    fn default() -> Self {
        CameraImages { color: true, depth: true, labels: true }
    }
}

/// An error that prevents the pictures of a camera.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A field of [`RobotCamera`] is out of range.
    #[error("`{field}` of a camera must be {allowed}, got {value}")]
    Setting {
        /// The name of the field.
        field: &'static str,
        /// The value of the field.
        value: f64,
        /// The allowed values.
        allowed: String,
    },
    /// The app has no renderer.
    #[error(
        "a camera needs an app with Bevy's `RenderPlugin` and a Vulkan, Metal or DirectX driver"
    )]
    NoRenderer,
    /// The robot is not in an environment.
    #[error(
        "a robot with a camera must be a child of an `Environment`, or there must be exactly one in the app"
    )]
    NoEnvironment,
    /// The world is endless.
    #[error("a camera needs a finite world, but this one is endless")]
    Endless,
    /// The entity that draws the colours was despawned.
    #[error("the camera entity below the robot was despawned; insert `RobotCamera` again")]
    NoEye,
    /// The world has too many triangles.
    #[error("the world has {found} triangles, but a camera can see at most {limit}")]
    TooManyTriangles {
        /// The number of triangles of the world.
        found: usize,
        /// The largest allowed number.
        limit: usize,
    },
    /// The driver failed.
    #[error("the driver returned no image: {0}")]
    Driver(String),
}

impl RobotCamera {
    /// Checks all fields.
    ///
    /// # Errors
    /// Returns an error with the first field that is out of range, its value and the allowed values.
    pub fn check(&self) -> Result<(), CameraError> {
        let lengths = [("forward", self.forward), ("left", self.left), ("up", self.up)];
        let offsets = -MAX_OFFSET..=MAX_OFFSET;
        let lengths = lengths.map(|(field, value)| (field, value, offsets.clone(), "of metres "));
        let others = [
            ("pitch", self.pitch, -90.0..=90.0, "of degrees "),
            ("yaw", self.yaw, -180.0..=180.0, "of degrees "),
            ("field_of_view", self.field_of_view, FIELDS_OF_VIEW, "of degrees "),
            ("rate", self.rate, RATES, "per second "),
        ];
        for (field, value, range, unit) in lengths.into_iter().chain(others) {
            if !range.contains(&value) {
                let allowed = format!("a number {unit}from {} to {}", range.start(), range.end());
                return Err(CameraError::Setting { field, value, allowed });
            }
        }
        for (field, value) in [("width", self.width), ("height", self.height)] {
            if !(1..=MAX_PIXELS).contains(&value) {
                let allowed = format!("1 to {MAX_PIXELS} pixels");
                return Err(CameraError::Setting { field, value: value.into(), allowed });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(camera: RobotCamera) -> String {
        camera.check().unwrap_err().to_string()
    }

    #[test]
    fn wrong_cameras_are_refused() {
        let usual = RobotCamera::default();
        assert_eq!(usual.check(), Ok(()));
        assert_eq!(
            error(RobotCamera { width: 0, ..usual }),
            "`width` of a camera must be 1 to 4096 pixels, got 0"
        );
        assert_eq!(
            error(RobotCamera { height: 4097, ..usual }),
            "`height` of a camera must be 1 to 4096 pixels, got 4097"
        );
        assert_eq!(
            error(RobotCamera { field_of_view: f64::NAN, ..usual }),
            "`field_of_view` of a camera must be a number of degrees from 1 to 170, got NaN"
        );
        assert_eq!(
            error(RobotCamera { rate: 0.0, ..usual }),
            "`rate` of a camera must be a number per second from 0.001 to 1000, got 0"
        );
        assert_eq!(
            error(RobotCamera { up: f64::INFINITY, ..usual }),
            "`up` of a camera must be a number of metres from -10 to 10, got inf"
        );
        assert_eq!(
            error(RobotCamera { pitch: 91.0, ..usual }),
            "`pitch` of a camera must be a number of degrees from -90 to 90, got 91"
        );
    }
}
