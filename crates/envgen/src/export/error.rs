//! Why a world cannot be written.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::file::FileError;
use crate::landscape::metrics::RasterError;
use crate::occupancy::OccupancyError;
#[cfg(feature = "picture")]
use crate::picture::PictureError;
use crate::scenario::ScenarioFileError;

/// Why a world could not be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The file's name has the ending of no format.
    #[error("unknown file ending in `{path}`, expected one of {known}")]
    UnknownEnding {
        /// The file's name.
        path: PathBuf,
        /// The endings that exist.
        known: String,
    },
    /// The format is in another build of the crate.
    #[error(
        "`{path}` needs the feature `{feature}`, which this build of envgen does not have: \
         `cargo install --path crates/envgen --features cli,{feature}`"
    )]
    Feature {
        /// The file's name.
        path: PathBuf,
        /// The feature of the crate.
        feature: &'static str,
    },
    /// Writing failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The format holds blueprints of another kind than this world's.
    #[error("{format} holds {wanted}, but this world was not built from one")]
    Blueprint {
        /// The format.
        format: &'static str,
        /// What it holds.
        wanted: &'static str,
    },
    /// The world cannot be written to a world file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The world's raster is invalid.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// The world has no part that the format can hold.
    #[error("the world has no {part}, and files of this format hold nothing else")]
    Empty {
        /// The part that the format holds.
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
        /// The most that it holds.
        limit: &'static str,
    },
    /// No grid of the world could be made.
    #[error(transparent)]
    Occupancy(#[from] OccupancyError),
    /// The world cannot be drawn.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] PictureError),
}
