//! Pictures and films of what cameras see, with or without a window.
//!
//! An app that draws adds [`CapturePlugin`] and triggers [`TakePicture`] on a camera. Tests,
//! servers and scripts without a display use a [`Studio`]: an app that draws into images, on a
//! graphics card or with Mesa's software Vulkan. [`Film`] makes an animated GIF of its pictures,
//! and [`Frames`] a folder of PNGs.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_envgen::capture::Studio;
//! use bevy_envgen::prelude::*;
//!
//! let mut studio = Studio::new()?;
//! studio.app().add_plugins(EnvgenPlugins::default());
//! let environment = Environment::new(IndoorSpec::default(), 7);
//! let world = studio.app().world_mut().spawn(environment).id();
//! studio.wait_until_ready(world)?;
//! let camera = studio.camera_over(world, UVec2::new(800, 600))?;
//! studio.picture(camera)?.write_png("indoor.png")?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod film;
mod picture;
mod request;
mod studio;

use std::path::PathBuf;

use bevy::prelude::*;
use envgen::SpecError;
use thiserror::Error;

use crate::EnvironmentError;

pub use film::{Film, Frames};
pub use picture::Picture;
pub use request::{CapturePlugin, PictureFailed, PictureTaken, TakePicture};
pub use studio::{MAX_SIDE, Studio, find_renderer};

/// Why a picture or film cannot be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The machine has no driver that can draw.
    #[error(
        "no Vulkan, Metal or DirectX driver was found ({reason}); without a graphics card, Mesa's software \
         Vulkan can draw; on Debian and Ubuntu: `apt-get install mesa-vulkan-drivers`"
    )]
    NoRenderer {
        /// The message of the search for drivers.
        reason: String,
    },
    /// The entity is not a camera whose picture can be taken.
    #[error("{camera} is not a camera that draws into an image or a window")]
    NoCamera {
        /// The entity.
        camera: Entity,
    },
    /// The size of the picture is out of range.
    #[error("the sides of a picture must be 1 to {MAX_SIDE} pixels, got {width} x {height}")]
    Size {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
    /// The format of the camera's image has no colours, for instance a depth format.
    #[error("the image must have colours, got the format {format}")]
    Format {
        /// The format.
        format: String,
    },
    /// The size of a frame differs from that of the film.
    #[error("the frame must have {expected} pixels like the film, got {found}")]
    OtherSize {
        /// The frame's size.
        found: UVec2,
        /// The film's.
        expected: UVec2,
    },
    /// The driver did not deliver the picture.
    #[error("the driver delivered no picture within {frames} frames")]
    Lost {
        /// Number of frames waited for.
        frames: u32,
    },
    /// An argument is out of range.
    #[error(transparent)]
    Argument(#[from] SpecError),
    /// The environment failed.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// The entity has no world.
    #[error("{entity} has no `GroundTruth`: is its `Environment` ready?")]
    NoWorld {
        /// The entity.
        entity: Entity,
    },
    /// The file could not be written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The error of the file system.
        source: std::io::Error,
    },
}
