//! Mapping trials: a simulated robot maps a world that it does not know, and the map that it made
//! is scored against what could be mapped. Difficulty is measured, not requested.
//!
//! ```
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//! use mapping_trial::trial::{Trial, TrialSettings};
//!
//! let world = HallwaySpec { segments: 3, ..Default::default() }.generate(Seed(7))?.to_world();
//! let mut trial = Trial::flat(&world, TrialSettings { time_limit: 60.0, ..Default::default() })?;
//! while trial.step() {}
//! let scores = trial.score(&trial.reference(&world)?)?;
//! assert!(scores.coverage > 0.2 && scores.difficulty < 10.0);
//!
//! // The log replays the trial exactly.
//! let again = trial.log().replay()?;
//! assert_eq!(again.trajectory(0), trial.trajectory(0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! | what | where |
//! |---|---|
//! | the robot and its sensors | [`robot`], [`lidar`], [`odometry`], [`water`] |
//! | robot backends: they take commands and give observations | [`backend`], [`flat`] |
//! | where the robot is, and what is around it | [`slam`], [`map`] |
//! | where it goes next | [`policy`] |
//! | both together: observation in, command out | [`autonomy`] |
//! | programs in processes of their own in their place | `driver` |
//! | pictures of maps | `picture` |
//! | bags of ROS 2 | `ros_bag` |
//! | the protocol: clock, ends, log and replay | [`trial`] |
//! | what could be mapped, and how well it was | [`mappable_area`], [`score`] |
//! | trajectories as text | [`tum`] |
//! | the operator's rating of it | [`feedback`] |
//! | many trials at once, and their statistics | `experiment` |
//! | how difficult a world is, measured by trials | `difficulty` |
//!
//! # Guarantees
//!
//! - The same world, settings and seed give the same trial to the last bit, on every platform, in
//!   debug and release, with any number of threads.
//! - Metres, radians and seconds in `f64`; the map's frame is the world's, since a trial gives its
//!   robots the poses where they start.

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod autonomy;
pub mod backend;
#[cfg(feature = "experiment")]
pub mod difficulty;
#[cfg(feature = "driver")]
pub mod driver;
#[cfg(feature = "experiment")]
pub mod experiment;
pub mod feedback;
pub mod flat;
pub mod lidar;
pub mod map;
pub mod mappable_area;
pub mod names;
pub mod odometry;
#[cfg(feature = "picture")]
pub mod picture;
pub mod policy;
pub mod robot;
#[cfg(feature = "mcap")]
pub mod ros_bag;
mod ros_map;
pub mod score;
mod setting_limits;
pub mod slam;
pub mod trial;
pub mod tum;
pub mod water;

/// The snippets of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
