//! Errors of writing worlds.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::file::FileError;
use crate::landscape::metrics::RasterError;
use crate::occupancy::OccupancyError;
#[cfg(feature = "picture")]
use crate::picture::PictureError;
use crate::scenario::ScenarioFileError;

/// The reasons why a world could not be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The ending of the file's name does not belong to any format.
    #[error("unknown file ending in `{path}`, expected one of {known}")]
    UnknownEnding {
        /// The file's name.
        path: PathBuf,
        /// The endings that exist.
        known: String,
    },
    /// The format is only in builds of the crate with another feature.
    #[error(
        "`{path}` needs the feature `{feature}`, which this build of envgen does not have: \
         `cargo install --path crates/envgen --features cli,{feature}`"
    )]
    Feature {
        /// The file's name.
        path: PathBuf,
        /// The feature of the crate that the format needs.
        feature: &'static str,
    },
    /// The name of a file to which another file of the format refers is not text.
    #[error("the name of `{path}` must be UTF-8, because another file of this format contains it")]
    Name {
        /// The file's name.
        path: PathBuf,
    },
    /// Writing failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The format contains blueprints of another kind than this world's.
    #[error(
        "{format} holds {wanted}, which is written only where a world of that kind is generated or edited"
    )]
    Blueprint {
        /// The format.
        format: &'static str,
        /// What the format contains.
        wanted: &'static str,
    },
    /// The world cannot be written as a world file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The world's raster is invalid.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// The world has no part that the format can contain.
    #[error("the world has no {part}, and files of this format hold nothing else")]
    Empty {
        /// The part that the format contains.
        part: &'static str,
    },
    /// The scenario cannot be written.
    #[error(transparent)]
    Scenario(#[from] ScenarioFileError),
    /// A part of the world has no mesh.
    #[cfg(feature = "mesh")]
    #[error(transparent)]
    Mesh(#[from] crate::mesh::MeshError),
    /// The world is larger than files of the format can be.
    #[error("the world takes more than the {limit} that a file of {format} can hold")]
    TooLarge {
        /// The format.
        format: &'static str,
        /// The limit of the format.
        limit: &'static str,
    },
    /// An occupancy grid of the world could not be made.
    #[error(transparent)]
    Occupancy(#[from] OccupancyError),
    /// The world cannot be drawn.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] PictureError),
}
