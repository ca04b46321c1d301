//! Mapping trials: a simulated robot maps a world that it does not know, and its map is scored against
//! what it could have mapped. Such trials measure how difficult a world is.
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
//! | Task | Modules |
//! |---|---|
//! | Robots and their sensors | [`robot`], [`lidar`], [`odometry`], [`water`] |
//! | Robot backends, which take commands and give observations | [`backend`], [`flat`] |
//! | Localisation and mapping | [`slam`], [`map`] |
//! | Exploration: where a robot goes next | [`policy`] |
//! | SLAM and policy together, from observations to commands | [`autonomy`] |
//! | Programs in other processes that take their place | `driver` |
//! | Pictures of maps | `picture` |
//! | Bags of ROS 2 | `ros_bag` |
//! | Trials: clock, end conditions, log and replay | [`trial`] |
//! | The area that can be mapped, and the scores of a map | [`mappable_area`], [`score`] |
//! | Trajectories as text | [`tum`] |
//! | Ratings by human operators | [`feedback`] |
//! | Many trials at once, and their statistics | `experiment` |
//! | The difficulty of a world, measured by trials | `difficulty` |
//! | Names and files on command lines and in surveys | [`names`], [`profile`] |
//!
//! # Guarantees
//!
//! - The same world, settings and seed give the same trial to the last bit: on every platform, in debug
//!   and release builds, and with any number of threads.
//! - Lengths, angles and times are `f64` in metres, radians and seconds. The map has the frame of the
//!   world, since a trial gives its robots the poses where they start.

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
pub mod profile;
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
