//! Seeded random worlds for robots.
//!
//! A spec and a seed give a blueprint, a blueprint gives a [`World`] in metres, and everything else reads that
//! world.
//!
//! ```
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//! use envgen::raycast::{ScanPattern, Raycaster};
//!
//! let spec = HallwaySpec { segments: 80, p_st: 0.2, ..Default::default() };
//! let hallway = spec.generate(Seed(7))?;
//! let world = hallway.to_world();
//!
//! // A laser scan from the start.
//! let mut ranges = Vec::new();
//! let scanner = ScanPattern::new(std::f64::consts::PI, 181)?;
//! let start = world.start.expect("a hallway has a start");
//! Raycaster::new(&world).scan(start, &scanner, 8.0, &mut ranges);
//! assert_eq!(ranges.len(), 181);
//! # Ok::<(), envgen::GenerateError>(())
//! ```
//!
//! # Overview
//!
//! | what | where |
//! |---|---|
//! | generators, one module per kind | [`hallway`], [`forest`], [`road`], [`indoor`], [`landscape`], [`cellular`] |
//! | any kind at once, as in RON files and on the command line | [`WorldSpec`], [`WorldKind`], [`mod@settings`], [`assignment`] |
//! | seeds and named random streams | [`Seed`], [`Stream`], [`distribution`] |
//! | output of the generators | [`World`], [`world`], [`geometry`], [`GridFrame`] |
//! | queries and checks of a world | [`occupancy`], [`raycast`], [`clearance_index`], [`surface_index`], [`placement`], [`mod@distance`], [`certificate`], [`reproduction`], `picture` |
//! | manual changes, with undo and redo | [`edit`] |
//! | doors, people and smoke | [`scenario`] |
//! | how difficult a world is to map | [`difficulty`], [`calibration`] |
//! | bodies in three dimensions | [`pieces`], [`mod@outline`], `mesh` |
//! | colours of pictures | [`palette`] |
//! | files | [`export`], [`import`], [`mod@file`], [`text_file`], `whole_file` |
//! | errors that name a file or an option | [`located`] |
//!
//! # Guarantees
//!
//! - The same spec, seed and crate version give the same world, to the last bit, on every platform, with every set
//!   of features and any number of threads.
//! - Lengths are in metres, angles in radians and times in seconds, as `f64`; x points right, y up, and headings
//!   are counter-clockwise from +x.
//! - Every spec is validated; an error names the field, the value and the allowed values. No spec causes a panic,
//!   or takes unbounded time or memory.
//! - An invalid number is never silently replaced: NaN, a negative number, or a zero that is not allowed is an
//!   error, or a documented panic where only a mistake in the program can cause it.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `formats` | yes | all of the following formats, up to `usarsim` |
//! | `barn` | yes | reading the worlds of the BARN data set |
//! | `csv` | yes | the waypoints of roads, and the solid parts of worlds, as comma-separated values |
//! | `geojson` | yes | parts of worlds as GeoJSON |
//! | `gltf` | yes | worlds as glTF 2.0, in one binary file |
//! | `mesh` | yes | worlds as closed triangle meshes |
//! | `mjcf` | yes | worlds for MuJoCo, as MJCF |
//! | `opendrive` | yes | roads and solid parts as OpenDRIVE |
//! | `paths` | yes | least-cost paths on landscapes, and the maps and scenarios of MovingAI |
//! | `rmf` | yes | buildings for Open-RMF |
//! | `ros` | yes | reading maps of ROS and Nav2; writing them needs no feature |
//! | `sdf` | yes | worlds for Gazebo, as SDFormat |
//! | `usarsim` | yes | projects and libraries of the World Generator for `USARSim` |
//! | `parallel` | yes | large rasters are counted on all cores, and a difficulty vector is computed on two |
//! | `picture` | yes | SVG and PNG pictures, drawn on the CPU |
//! | `usd` | no | worlds as Universal Scene Description; its crate changes how PNG files are compressed in the whole build |
//! | `rand` | no | worlds drawn from any distribution of `rand` and `rand_distr`; see [`distribution`] |
//! | `bevy_reflect` | no | `Reflect` for kinds of parts, for Bevy's inspectors and scenes; `bevy_envgen` enables it |
//! | `whole-file` | no | files that are written either completely or not at all |
//! | `cli` | no | the command `envgen` |

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod assignment;
pub mod calibration;
pub mod cellular;
pub mod certificate;
mod changed_settings;
pub mod clearance_index;
pub mod curve;
mod dials;
pub mod difficulty;
pub mod distance;
pub mod distribution;
mod doorways;
pub mod edit;
mod error;
pub mod export;
pub mod file;
mod flood;
pub mod forest;
mod generate;
pub mod geometry;
mod grid;
pub mod hallway;
mod history;
pub mod import;
pub mod indoor;
mod kind;
pub mod landscape;
pub mod located;
#[cfg(feature = "mesh")]
pub mod mesh;
pub mod occupancy;
pub mod outline;
pub mod palette;
#[cfg(feature = "picture")]
pub mod picture;
pub mod pieces;
pub mod placement;
mod provenance;
pub mod raycast;
pub mod reproduction;
pub mod road;
pub mod scenario;
mod seed;
pub mod settings;
mod spec;
pub mod surface_index;
pub mod text_file;
mod union_find;
#[cfg(feature = "whole-file")]
pub mod whole_file;
pub mod world;
#[cfg(any(feature = "mjcf", feature = "opendrive", feature = "sdf", feature = "usarsim"))]
mod xml_text;

pub use error::SpecError;
pub use generate::{Blueprint, Spec};
pub use grid::GridFrame;
pub use provenance::{MeasuredDifficulty, Provenance};
pub use seed::{STREAM_ALGORITHM, Seed, Stream};
pub use spec::{GenerateError, SettingsError, WorldBlueprint, WorldKind, WorldMetrics, WorldSpec};
pub use world::World;

pub use glam;
#[doc(hidden)]
pub use serde_json;
#[doc(hidden)]
pub use strum;

/// The snippets of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
