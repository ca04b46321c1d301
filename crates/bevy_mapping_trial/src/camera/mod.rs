//! Cameras on robots, which take colour, depth and label images.
//!
//! The component [`RobotCamera`] gives a robot a camera. For colour images, a
//! [`Camera3d`](bevy::prelude::Camera3d) follows the robot and draws into an image that the app can show,
//! [`RobotCameraView`]. It draws whatever the app has in three dimensions, such as the worlds of
//! [`bevy_envgen`] with its `EnvgenVisuals3dPlugin`. Depth and label images need no plugin for drawing. They
//! show the bodies of the world ([`envgen::pieces`]) as meshes, with ceilings if `Visuals3dSettings` has
//! them, and the doors and people of the scenario and all robots, either as the app draws them, or else as simple
//! bodies. Other meshes of the app are in colour images alone. When all images are complete, they are reported
//! as a [`CameraFrame`] with the event [`CameraFrameTaken`].
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_mapping_trial::camera::{CameraFrameTaken, RobotCamera, RobotCameraPlugin};
//! use bevy_mapping_trial::trial::TrialRobot;
//!
//! let mut app = App::new();
//! // With Bevy's plugins for drawing, a world and a trial.
//! app.add_plugins(RobotCameraPlugin);
//! app.add_observer(|robot: On<Add, TrialRobot>, mut commands: Commands| {
//!     commands.entity(robot.entity).insert(RobotCamera { rate: 5.0, ..default() });
//! });
//! app.add_observer(|taken: On<CameraFrameTaken>| {
//!     let depth = taken.frame.depth.iter().flatten().copied().fold(f32::INFINITY, f32::min);
//!     println!("{:.2} s: the nearest surface is {depth:.3} m ahead", taken.frame.time);
//! });
//! ```
//!
//! # How exact depths are
//!
//! The graphics card decides which triangle is visible at each pixel. The depth of the pixel is where the ray
//! through its centre meets the plane of that triangle, in double precision. Depths are equal to those of
//! [`BodyRaycaster`](envgen::mesh::BodyRaycaster), except at silhouettes, where drivers round the edges of
//! triangles to a fraction of a pixel. Where surfaces of two bodies coincide, the label may be that of
//! either.
//!
//! # When
//!
//! Pictures are taken at the end of frames of the app, at the requested rate in simulated time, as soon as
//! the pose of the robot is known. They do not affect the trial. Depth and label images wait for the graphics
//! card. Colour images arrive a frame or two later, and their camera draws only when a picture is taken.

mod files;
mod frame;
mod labels;
mod moving;
mod optics;
mod pass;
mod plugin;
mod record;
mod scene;
mod settings;
mod shutter;

pub use files::{CameraFolder, DEPTH_UNIT, OTHER_LABEL};
pub use frame::CameraFrame;
pub use labels::{Label, Labels};
pub use optics::{CameraOptics, CameraPose};
pub use plugin::{RobotCameraPlugin, RobotCameraSystems};
pub use record::{CameraRecording, CameraTrial, RecordingError};
pub use scene::MAX_TRIANGLES;
pub use settings::{CameraError, CameraImages, MAX_PIXELS, RobotCamera};
pub use shutter::{CameraFailed, CameraFrameTaken, RobotCameraView};
