//! Cameras on robots: what a robot sees, as colours, depths and labels.
//!
//! [`RobotCamera`] on a robot makes it see. For colours a [`Camera3d`](bevy::prelude::Camera3d) follows the robot and
//! draws into an image that the app can show, [`RobotCameraView`]; it draws what the app has in three dimensions, such
//! as the worlds of [`bevy_envgen`] with its `EnvgenVisuals3dPlugin`. Depths and labels need no plugin for drawing: they
//! show the bodies of the world ([`envgen::pieces`]) as meshes, with ceilings where `Visuals3dSettings` has them, the
//! doors and people of its scenario, and the robots of its trial: as the app draws them, else as simple bodies. Each
//! image that is complete is a [`CameraFrame`], which comes with [`CameraFrameTaken`].
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
//! The graphics card decides which triangle each pixel shows; its depth is where the ray through the middle of the
//! pixel meets the plane of the triangle, in double precision. Depths are those of
//! [`BodyRaycaster`](envgen::mesh::BodyRaycaster) but at silhouettes, where drivers round the edges of triangles to
//! a fraction of a pixel. Surfaces of two bodies at the same place may have the label of either.
//!
//! # When
//!
//! Pictures are taken at the end of the frames of the app, as many per simulated second as asked for, from the time on
//! at which the robot's pose is known. They change nothing in the trial. Depths and labels wait for the graphics
//! card; colours arrive a frame or two later, and the camera for them draws only when a picture is taken.

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
