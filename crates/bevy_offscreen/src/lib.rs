//! Takes pictures and films of what Bevy's cameras see, with or without a window.
//!
//! An app that draws adds `CapturePlugin` and triggers `TakePicture` on a camera. Tests, servers and scripts
//! without a display use a `Studio`, which is an app that draws into images, on a graphics card or with
//! Mesa's software Vulkan. [`Film`] makes an animated GIF of the pictures, and [`Frames`] a folder of PNG
//! files.
//!
//! ```no_run
//! # #[cfg(feature = "render")]
//! # {
//! use bevy::prelude::*;
//! use bevy_offscreen::Studio;
//!
//! let mut studio = Studio::new()?;
//! studio.app().world_mut().spawn(Sprite::from_color(Color::WHITE, Vec2::new(4.0, 2.0)));
//! let camera = studio.camera(Rect::new(-5.0, -5.0, 5.0, 5.0), UVec2::new(800, 600))?;
//! studio.picture(camera)?.write_png("sprite.png")?;
//! # }
//! # Ok::<(), bevy_offscreen::CaptureError>(())
//! ```
//!
//! # Features
//!
//! | feature | default | what it adds |
//! |---|---|---|
//! | `render` | no | `Studio`, `CapturePlugin`, `TakePicture`, `DrawnFrames` and `find_renderer`; only this feature and those that include it need rendering crates |
//! | `render3d` | no | cameras in three dimensions for `Studio` |
//!
//! Without features the crate has [`CapturedImage`], [`Film`] and [`Frames`], for images that the app already
//! has.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod captured_image;
#[cfg(feature = "render")]
mod drawn_frames;
mod error;
mod film;
#[cfg(feature = "render")]
mod request;
#[cfg(feature = "render")]
mod studio;
mod whole_file;

pub use captured_image::CapturedImage;
#[cfg(feature = "render")]
pub use drawn_frames::{DrawnFrames, DrawnFramesPlugin};
pub use error::{CaptureError, MAX_SIDE};
pub use film::{Film, Frames};
#[cfg(feature = "render")]
pub use request::{CapturePlugin, PictureFailed, PictureTaken, TakePicture};
#[cfg(feature = "render")]
pub use studio::{Studio, find_renderer};

/// The doctests of the README.
#[cfg(all(doctest, feature = "render"))]
#[doc = include_str!("../README.md")]
struct Readme;
