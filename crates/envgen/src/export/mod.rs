//! Writing worlds, in the format that the ending of the file's name selects.
//!
//! A [`Format`] is one line of a table, with a summary of the format and, for each of its files, the ending and the
//! function that writes it. Most formats have one file. A format with several files, such as an image with its
//! description, lists the file that refers to the others first.
//!
//! ```
//! use envgen::export::{Format, Job};
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//!
//! let world = HallwaySpec::default().generate(Seed(7))?.to_world();
//! let format = Format::from_path("hallway.json".as_ref())?;
//! let mut file = Vec::new();
//! format.write(&Job::new(&world), &mut file)?;
//! assert_eq!(envgen::import::read_json(&mut file.as_slice())?, world);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod asc;
#[cfg(any(feature = "mjcf", feature = "sdf", feature = "usd"))]
mod body;
#[cfg(feature = "rmf")]
mod building;
#[cfg(feature = "picture")]
pub mod class_png;
#[cfg(feature = "csv")]
mod csv;
mod error;
mod format;
#[cfg(feature = "geojson")]
mod geojson;
#[cfg(feature = "gltf")]
mod gltf;
mod houseexpo;
mod job;
#[cfg(feature = "rmf")]
mod lanes;
#[cfg(feature = "mjcf")]
mod mjcf;
#[cfg(feature = "paths")]
pub mod movingai;
#[cfg(feature = "csv")]
mod obstacles_csv;
#[cfg(feature = "opendrive")]
mod opendrive;
#[cfg(feature = "whole-file")]
mod output;
#[cfg(any(feature = "gltf", feature = "mjcf", feature = "sdf", feature = "usd"))]
mod places;
#[cfg(feature = "opendrive")]
mod road_objects;
pub mod ros_map;
#[cfg(feature = "sdf")]
mod sdf;
#[cfg(feature = "usd")]
mod usd;
#[cfg(feature = "csv")]
mod waypoints;
#[cfg(any(feature = "mjcf", feature = "opendrive", feature = "sdf"))]
mod xml;
mod yaml;

pub use asc::write_asc;
pub use error::ExportError;
pub use format::{Format, Writer};
pub use job::Job;
#[cfg(feature = "whole-file")]
pub use output::{Output, OutputError, write_whole};
