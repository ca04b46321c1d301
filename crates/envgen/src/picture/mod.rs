//! Pictures of a world: SVG, and PNG drawn from exactly that SVG, on the CPU.
//!
//! A picture is made from the [`World`] alone. It shows every kind of part in its own colour, start
//! (a disc with an arrow along the heading) and goal (a flag), a scale bar, and a legend of the parts
//! that occur. Labels are outlines of an embedded font, coordinates are rounded to a fraction of a pixel:
//! the same world and options give the same SVG text, and the same pixels, everywhere.
//!
//! ```
//! use envgen::picture::{self, PictureOptions};
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//!
//! let world = HallwaySpec::default().generate(Seed(7))?.to_world();
//! let options = PictureOptions { width: 400, ..Default::default() };
//! assert!(picture::svg(&world, &options)?.starts_with("<svg"));
//! assert!(picture::png(&world, &options)?.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A world with very many parts still gives a small file quickly: all parts of a style are one path,
//! and parts smaller than a pixel are drawn together as a shadow, an image of how much of each pixel
//! they cover.

mod figure;
mod hatch;
mod ink;
mod labels;
mod legend;
mod moving;
mod page;
mod parts;
mod path;
mod pixels;
mod profile;
mod raster;
mod roads;
mod shapes;
mod style;
mod symbols;
mod text;
mod title;
mod view;

pub use figure::Figure;
pub use pixels::Pixels;

use std::io::{self, Write};

use thiserror::Error;

use crate::error::SpecError;
use crate::geometry::Rect;
use crate::scenario::Scenario;
use crate::world::{Violation, World};

/// The narrowest and widest picture, in px.
pub const WIDTHS: [u32; 2] = [100, 16_384];

/// The lowest and highest plan, in px.
pub const HEIGHTS: [u32; 2] = [50, 16_384];

/// The most pixels that a PNG may have: 64 Mi, for which drawing takes some 256 MiB.
pub const MAX_PIXELS: u64 = 1 << 26;

/// How a world is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Greatest width of the picture in px, within [`WIDTHS`]. The picture is as large as it can
    /// be; high worlds give narrower ones.
    pub width: u32,
    /// Greatest height of the world in the picture in px, within [`HEIGHTS`]; title, legend and
    /// curvature profile are added to it.
    pub height: u32,
    /// Pixels of a PNG per px of the picture, from 0.1 to 10; 2 for dense screens.
    pub pixel_ratio: f64,
    /// White space on the four sides of the picture in px, at most 200.
    pub margin: u32,
    /// Title above the world; `None` for kind, seed and the settings that differ from the defaults, an
    /// empty text for no title.
    pub title: Option<String>,
    /// Whether a legend explains the colours.
    pub legend: bool,
    /// Whether the names of rooms are shown.
    pub names: bool,
    /// Whether a grid of round metres lies under the world.
    pub grid: bool,
    /// Whether the curvature of roads over their length is drawn under the world.
    pub curvature_profile: bool,
    /// What moves in the world: doors with their swing, people with their routes of the first minute, smoke.
    pub scenario: Option<Scenario>,
}

impl Default for PictureOptions {
    fn default() -> Self {
        PictureOptions {
            width: 1000,
            height: 800,
            pixel_ratio: 1.0,
            margin: 16,
            title: None,
            legend: true,
            names: true,
            grid: false,
            curvature_profile: false,
            scenario: None,
        }
    }
}

/// Why a world could not be drawn.
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
        /// Which option.
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
        /// Its width.
        width: u64,
        /// Its height.
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

impl PictureOptions {
    /// Checks the options against their limits.
    ///
    /// # Errors
    /// Names the first option that is not allowed.
    pub fn validate(&self) -> Result<(), PictureError> {
        let check = |option, value: f64, min: f64, max: f64| {
            let inside = value >= min && value <= max;
            if inside { Ok(()) } else { Err(PictureError::Option { option, value, min, max }) }
        };
        let [narrowest, widest] = WIDTHS.map(f64::from);
        check("width", self.width.into(), narrowest, widest)?;
        let [lowest, highest] = HEIGHTS.map(f64::from);
        check("height", self.height.into(), lowest, highest)?;
        check("margin", self.margin.into(), 0.0, 200.0)?;
        check("pixel_ratio", self.pixel_ratio, 0.1, 10.0)
    }
}

/// The picture of a world as SVG.
///
/// # Errors
/// When the world breaks an invariant, an option is out of its limits, or the world has no finite
/// scale.
pub fn svg(world: &World, options: &PictureOptions) -> Result<String, PictureError> {
    let mut text = Vec::new();
    write_svg(world, options, &mut text)?;
    // All that was written is UTF-8.
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Writes the picture of a world as SVG.
///
/// # Errors
/// Those of [`svg()`], and when writing fails.
pub fn write_svg(
    world: &World,
    options: &PictureOptions,
    out: &mut dyn Write,
) -> Result<(), PictureError> {
    options.validate()?;
    world.check()?;
    svg::write(&mut *out, &page::document(world, options)?)?;
    Ok(writeln!(out)?)
}

/// The picture of a world as a PNG file: [`svg()`] rendered by `resvg`.
///
/// # Errors
/// Those of [`svg()`], and when there would be more than [`MAX_PIXELS`].
pub fn png(world: &World, options: &PictureOptions) -> Result<Vec<u8>, PictureError> {
    let mut file = Vec::new();
    write_png(world, options, &mut file)?;
    Ok(file)
}

/// Writes the picture of a world as a PNG file.
///
/// # Errors
/// Those of [`png()`], and when writing fails.
pub fn write_png(
    world: &World,
    options: &PictureOptions,
    out: &mut dyn Write,
) -> Result<(), PictureError> {
    pixels(world, options)?.write(out)
}

/// The pixels of the picture of a world, for windows and programs that show it.
///
/// # Errors
/// Those of [`png()`].
pub fn pixels(world: &World, options: &PictureOptions) -> Result<Pixels, PictureError> {
    pixels::render(&svg(world, options)?, options.pixel_ratio)
}
