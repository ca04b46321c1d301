//! Bevy plugins for robots in rapier, and for mapping trials with these robots, in the worlds of
//! [`bevy_envgen`]. No window or renderer is needed.
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_envgen::prelude::*;
//! use bevy_mapping_trial::prelude::*;
//! use mapping_trial::trial::TrialSettings;
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, TransformPlugin, TopDownPhysicsPlugin::for_trials()));
//! app.add_plugins((EnvgenPlugins::default(), TrialPlugin::default()));
//! let trial = MappingTrial::new(TrialSettings::default());
//! app.world_mut().spawn((Environment::new(HallwaySpec::default(), 7), trial));
//! app.update(); // or app.run()
//! ```
//!
//! The module [`robot`] describes how robots drive and sense, and the module [`trial`] how trials run.
//!
//! # What is spawned
//!
//! ```text
//! Environment            MappingTrial, and ManualControl where a person drives
//!   Robot 1, ..          TrialRobot, RobotModel, Chassis, DriveCommand, Wheels, TruePose, Bumper,
//!                        Battery, WheelOdometry, LaserScanner, LaserScan, RobotCondition
//! ```
//!
//! # Events
//!
//! | event for observers | triggered on |
//! |---|---|
//! | [`TrialStarted`](trial::TrialStarted), [`TrialEnded`](trial::TrialEnded), [`TrialFailed`](trial::TrialFailed) | the environment of a trial |
//!
//! # Plugins
//!
//! | plugin | feature | adds |
//! |---|---|---|
//! | [`RobotPlugin`](robot::RobotPlugin) | | robots that drive and sense in rapier |
//! | [`TrialPlugin`](trial::TrialPlugin) | | mapping trials, with `RobotPlugin` |
//! | `TrialViewPlugin` | `render` | draws mapping trials |
//! | `RobotCameraPlugin` | `camera` | what robots see: colours, depths and labels |
//! | `RobotVisuals3dPlugin` | `render3d` | draws robots in three dimensions |
//! | `TrialDebugPlugin` | `debug` | lines over rays, frontiers and plans, with `EnvgenDebugPlugin` |
//!
//! # System sets
//!
//! Robots and trials run in rapier's schedule, which is `FixedUpdate` by default, before and after rapier:
//! [`TrialSystems::Command`](trial::TrialSystems), [`RobotSystems::Drive`](robot::RobotSystems), rapier's
//! `PhysicsSet`, [`ScenarioSystems`](bevy_envgen::ScenarioSystems),
//! [`RobotSystems::Sense`](robot::RobotSystems), [`TrialSystems::Record`](trial::TrialSystems).
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `render` | no | `view`, the drawing of trials; only this feature and those that include it, and `egui`, need rendering crates |
//! | `render3d` | no | `view3d`, robots in three dimensions; includes `render` and the feature `render3d` of [`bevy_envgen`] |
//! | `debug` | no | `debug`, lines over rays, frontiers and plans; includes `render` |
//! | `camera` | no | `camera`, cameras on robots, and trials recorded as pictures; includes `render3d` |
//! | `egui` | no | `ui`, panels for specs, trials, scores and the feedback form |
//! | `serialize` | no | serde for the properties of robots; the feature `serialize` of [`bevy_envgen`] |
//!
//! The default features include the default features of [`bevy_envgen`].

#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "camera")]
pub mod camera;
#[cfg(feature = "debug")]
pub mod debug;
pub mod robot;
pub mod trial;
#[cfg(feature = "egui")]
pub mod ui;
#[cfg(feature = "render")]
pub mod view;
#[cfg(feature = "render3d")]
pub mod view3d;

pub use bevy_envgen;
pub use bevy_rapier2d;
pub use mapping_trial;

/// The items that most apps need, in addition to the prelude of [`bevy_envgen`].
pub mod prelude {
    pub use crate::robot::{
        Battery, Bumper, Chassis, DriveCommand, LaserScan, LaserScanner, RobotModel, RobotPlugin,
        RobotSystems, TruePose, WheelOdometry,
    };
    pub use crate::trial::{
        ForTrials, ManualControl, MappingTrial, TrialEnded, TrialFailed, TrialPlugin, TrialRobot,
        TrialStarted, TrialSystems,
    };
}

/// The doctests of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
