//! Mapping trials: a simulated robot maps a world that it does not know, and the map that it made
//! is scored against the truth. Difficulty is measured, not asked.
//!
//! # Finding one's way
//!
//! | what | where |
//! |---|---|
//! | the robot and its sensors | [`robot`], [`lidar`], [`odometry`] |
//! | bodies that take commands and give observations | [`body`], [`flat`] |
//! | where am I and what is around me | [`slam`], [`map`] |
//! | where to next | [`operator`] |
//! | the two together: observation in, command out | [`brain`] |
//! | pictures of maps | `picture` |
//! | the protocol: clock, ends, log and replay | [`trial`] |
//! | what could be mapped, and how well it was | [`truth`], [`score`] |
//!
//! # What holds
//!
//! - The same world, settings and seed give the same trial to the last bit, on every platform, in
//!   debug and release, with any number of threads.
//! - Metres, radians and seconds in `f64`; the map's frame is the world's, since a trial tells its
//!   robots where they start.

pub mod body;
pub mod brain;
pub mod flat;
pub mod lidar;
pub mod map;
pub mod names;
pub mod odometry;
pub mod operator;
#[cfg(feature = "picture")]
pub mod picture;
pub mod robot;
pub mod score;
pub mod slam;
pub mod trial;
pub mod truth;
