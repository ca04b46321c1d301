//! Seeded random worlds for robots: what is asked (a spec) and a seed become a blueprint, a
//! blueprint becomes a [`World`] in metres, and everything else reads that one world.
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
//! # Finding one's way
//!
//! | what | where |
//! |---|---|
//! | generators, one module a kind | [`hallway`], [`forest`], [`road`], [`indoor`], [`landscape`] |
//! | any kind at once, as in RON files and on the command line | [`WorldSpec`], [`WorldKind`], [`settings`] |
//! | seeds and named random streams | [`Seed`], [`Stream`], [`distribution`] |
//! | what generators make | [`World`], [`world`], [`geometry`] |
//! | what reads a world | [`occupancy`], [`raycast`], [`proximity`], [`ground`], [`placement`], [`mod@distance`], [`certificate`], [`reproduction`], `picture` |
//! | files | [`export`], [`import`], [`mod@file`], `whole_file` |
//! | errors with the name of their file or option | [`located`] |
//!
//! # What holds
//!
//! - The same spec, seed and crate version give the same world, to the last bit, on every platform,
//!   with every set of features and any number of threads.
//! - Metres, radians and seconds in `f64`; x right, y up, headings counter-clockwise from +x.
//! - Every spec is validated; an error names the field, the value and what is allowed. Nothing
//!   panics or takes unbounded time or memory on any spec.
//! - No number is replaced in silence: NaN, a negative or a zero where none is allowed is an error,
//!   or a panic that the documentation names where only a mistake in the program can cause it.
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `parallel` | yes | large rasters are counted on all cores |
//! | `picture` | yes | SVG and PNG pictures, drawn on the CPU |
//! | `whole-file` | no | files that appear whole or not at all |
//! | `cli` | no | the command `envgen` |

pub mod certificate;
pub mod clearance_index;
pub mod curve;
pub mod distance;
pub mod distribution;
mod error;
pub mod export;
pub mod file;
mod flood;
pub mod forest;
mod generate;
pub mod geometry;
pub mod hallway;
pub mod import;
pub mod indoor;
pub mod landscape;
mod lattice;
pub mod located;
pub mod occupancy;
#[cfg(feature = "picture")]
pub mod picture;
pub mod placement;
mod provenance;
pub mod raycast;
pub mod reproduction;
pub mod road;
mod seed;
pub mod settings;
mod spec;
pub mod surface_index;
#[cfg(feature = "whole-file")]
pub mod whole_file;
pub mod world;

pub use error::{GenerateError, SpecError};
pub use generate::{Blueprint, Spec};
pub use provenance::Provenance;
pub use seed::{STREAM_ALGORITHM, Seed, Stream};
pub use spec::{SettingsError, WorldBlueprint, WorldKind, WorldMetrics, WorldSpec};
pub use world::World;

pub use glam;
