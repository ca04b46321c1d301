//! Why there is no picture.

use std::path::PathBuf;

use bevy::prelude::*;
use thiserror::Error;

/// The largest side of a picture in pixels, which every driver can draw.
pub const MAX_SIDE: u32 = 8192;

/// The number of frames after which a missing picture is an error.
#[cfg(feature = "render")]
pub(crate) const MOST_FRAMES: u32 = 100;

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
    #[error("the sides of a picture must be 1 to {largest} pixels, got {width} x {height}")]
    Size {
        /// Pixels from left to right.
        width: u32,
        /// Pixels from top to bottom.
        height: u32,
        /// The largest side in pixels.
        largest: u32,
    },
    /// The field of view is out of range.
    #[error("the field of view must be between 0 and pi radians, got {found}")]
    FieldOfView {
        /// The angle in radians.
        found: f32,
    },
    /// The pose of the camera is not one.
    #[error("the pose of a camera must be finite, with a rotation of length 1, got {found:?}")]
    Pose {
        /// The pose.
        found: Transform,
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
    /// The frame rate of a film is out of range.
    #[error("`frames_per_second` must be a number from 1 to 50, got {found}")]
    FrameRate {
        /// Frames per second.
        found: f64,
    },
    /// The driver did not deliver the picture.
    #[error("the driver delivered no picture within {frames} frames")]
    Lost {
        /// Number of frames waited for.
        frames: u32,
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
