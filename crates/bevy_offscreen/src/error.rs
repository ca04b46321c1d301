//! The reasons why a picture cannot be taken.

use std::path::PathBuf;

use bevy::prelude::*;
use thiserror::Error;

/// The largest side of a picture in pixels. Every driver can draw images of this size.
pub const MAX_SIDE: u32 = 8192;

/// The number of frames after which a picture that has not arrived is an error.
#[cfg(feature = "render")]
pub(crate) const MOST_FRAMES: u32 = 100;

/// An error that prevents a picture or film.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// The machine has no driver that can draw.
    #[error(
        "no Vulkan, Metal or DirectX driver was found ({reason}); without a graphics card, Mesa's software \
         Vulkan can draw; on Debian and Ubuntu: `apt-get install mesa-vulkan-drivers`"
    )]
    NoRenderer {
        /// The error message of the search for a driver.
        reason: String,
    },
    /// The entity is not a camera of which a picture can be taken.
    #[error("{camera} is not a camera that draws into an image or a window")]
    NoCamera {
        /// The entity.
        camera: Entity,
    },
    /// The size of the picture is out of range.
    #[error("the sides of a picture must be 1 to {largest} pixels, got {width} x {height}")]
    Size {
        /// The width in pixels.
        width: u32,
        /// The height in pixels.
        height: u32,
        /// The largest allowed side in pixels.
        largest: u32,
    },
    /// The area that a camera should show is not finite, too large, or its corners are exchanged.
    #[error("the area must be finite, and its `min` at most its `max`, got {found:?}")]
    Area {
        /// The area.
        found: Rect,
    },
    /// The field of view is out of range.
    #[error("the field of view must be between 0 and pi radians, got {found}")]
    FieldOfView {
        /// The angle in radians.
        found: f32,
    },
    /// The pose of the camera is not finite, or its rotation is not normalized.
    #[error("the pose of a camera must be finite, with a rotation of length 1, got {found:?}")]
    Pose {
        /// The pose.
        found: Transform,
    },
    /// The format of the camera's image cannot be written, such as a depth format or one with 16 bits per colour.
    #[error(
        "the image must have the format Rgba8UnormSrgb, Bgra8UnormSrgb, Bgra8Unorm, Rg8Unorm or R8Unorm, got \
         {format}"
    )]
    Format {
        /// The format.
        format: String,
    },
    /// The size of a frame differs from that of the film.
    #[error("the frame must have {expected} pixels like the film, got {found}")]
    OtherSize {
        /// The size of the frame.
        found: UVec2,
        /// The size of the film.
        expected: UVec2,
    },
    /// The frame rate of a film is out of range.
    #[error("`frames_per_second` must be a number from 1 to 50, got {found}")]
    FrameRate {
        /// The requested number of frames per second.
        found: f64,
    },
    /// The driver did not deliver the picture.
    #[error("the driver delivered no picture within {frames} frames")]
    Lost {
        /// The number of frames that the request waited.
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
