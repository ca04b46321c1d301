//! Errors of drawing worlds.

use std::io;

use thiserror::Error;

use crate::error::SpecError;
use crate::geometry::Rect;
use crate::world::Violation;

/// The greatest number of pixels of a PNG: 64 Mi, for which drawing takes about 256 MiB.
pub const MAX_PIXELS: u64 = 1 << 26;

/// The reasons why a world could not be drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The world breaks an invariant.
    #[error("the world is broken: {0}")]
    World(#[from] Violation),
    /// The scenario does not fit the world.
    #[error("the scenario does not fit the world: {0}")]
    Scenario(#[from] SpecError),
    /// An option is out of its limits.
    #[error("the picture's {option} must be from {min} to {max}, got {value}")]
    Option {
        /// The name of the option.
        option: &'static str,
        /// The requested value.
        value: f64,
        /// The least value.
        min: f64,
        /// The greatest value.
        max: f64,
    },
    /// The world is so small or so large that its scale is not a finite number.
    #[error("a world with the bounds {0:?} has no finite scale")]
    Scale(Rect),
    /// The cells of a map cannot be drawn.
    #[error("the cells of a map must {0}")]
    Cells(&'static str),
    /// The PNG would be too large.
    #[error("a PNG must have at most {MAX_PIXELS} pixels, got {width} x {height}")]
    TooLarge {
        /// The width of the PNG.
        width: u64,
        /// The height of the PNG.
        height: u64,
    },
    /// The picture could not be rendered.
    #[error("the picture cannot be rendered: {0}")]
    Render(#[from] resvg::usvg::Error),
    /// The image could not be encoded.
    #[error(transparent)]
    Encode(#[from] png::EncodingError),
    /// Writing failed.
    #[error(transparent)]
    Io(#[from] io::Error),
}
