//! Pictures and films of what cameras see, with or without a window.
//!
//! An app that draws adds [`CapturePlugin`] and triggers [`TakePicture`] on a camera. Tests, servers
//! and scripts without a display use a [`Studio`]: an app that draws into images, on a graphics card
//! or on Mesa's software Vulkan. [`Film`] makes an animated GIF of its pictures, and [`Frames`] a
//! folder of PNGs.
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

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// Nothing on this machine can draw.
    #[error(
        "no Vulkan, Metal or DirectX driver was found ({reason}); without a graphics card Mesa's software \
         Vulkan draws too: on Debian and Ubuntu `apt-get install mesa-vulkan-drivers`"
    )]
    NoRenderer {
        /// What the search said.
        reason: String,
    },
    /// The entity cannot be photographed.
    #[error("{camera} is no camera that draws into an image or a window")]
    NoCamera {
        /// The entity.
        camera: Entity,
    },
    /// The size is not one that can be drawn.
    #[error("a picture of {width} x {height} pixels, expected sides of 1 to {MAX_SIDE}")]
    Size {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
    },
    /// The camera's picture has a format that is no picture for eyes, for instance a depth.
    #[error("pixels of the format {format} make no picture")]
    Format {
        /// The format.
        format: String,
    },
    /// Frames of a film have one size.
    #[error("a frame of {found} pixels in a film of {expected}")]
    OtherSize {
        /// The frame's size.
        found: UVec2,
        /// The film's.
        expected: UVec2,
    },
    /// The picture did not come back from the driver.
    #[error("the driver gave no picture after {frames} frames")]
    Lost {
        /// Frames waited for.
        frames: u32,
    },
    /// An argument is not allowed.
    #[error(transparent)]
    Argument(#[from] SpecError),
    /// The environment that was to be seen is not there.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// The entity has no world that could be seen.
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
        /// What the system says.
        source: std::io::Error,
    },
}
