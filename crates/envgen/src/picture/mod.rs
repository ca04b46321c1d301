//! Pictures of a world: SVG, and PNG that is rendered from exactly that SVG, on the CPU.
//!
//! A picture is made from the [`World`] alone. It shows every kind of part in its own colour, the start (a disc
//! with an arrow along the heading), the goal (a flag), a scale bar, and a legend of the parts that occur. Labels
//! are outlines of an embedded font, and coordinates are rounded to a fraction of a pixel. The same world and
//! options therefore give the same SVG text, and the same pixels, on every machine.
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
//! Even a world with very many parts quickly gives a small file: all parts of a style are one path, and parts
//! smaller than a pixel are drawn together as a shadow, which is an image of the share of each pixel that they
//! cover.

mod error;
mod figure;
mod hatch;
mod ink;
mod labels;
mod legend;
mod moving;
mod options;
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

pub use error::{MAX_PIXELS, PictureError};
pub use figure::Figure;
pub use options::{HEIGHTS, PictureOptions, WIDTHS};
pub use pixels::Pixels;

use std::io::Write;

use crate::world::World;

/// Draws a world as SVG and returns the text.
///
/// # Errors
/// When the world breaks an invariant, when an option is out of its limits, or when the world has no finite scale.
pub fn svg(world: &World, options: &PictureOptions) -> Result<String, PictureError> {
    let mut text = Vec::new();
    write_svg(world, options, &mut text)?;
    // All that was written is UTF-8.
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Draws a world as SVG and writes the text.
///
/// # Errors
/// The errors of [`svg()`], and when writing fails.
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

/// Draws a world as PNG and returns the file: [`svg()`] rendered by `resvg`.
///
/// # Errors
/// The errors of [`svg()`], and when there would be more than [`MAX_PIXELS`].
pub fn png(world: &World, options: &PictureOptions) -> Result<Vec<u8>, PictureError> {
    let mut file = Vec::new();
    write_png(world, options, &mut file)?;
    Ok(file)
}

/// Draws a world as PNG and writes the file.
///
/// # Errors
/// The errors of [`png()`], and when writing fails.
pub fn write_png(
    world: &World,
    options: &PictureOptions,
    out: &mut dyn Write,
) -> Result<(), PictureError> {
    pixels(world, options)?.write(out)
}

/// Draws a world and returns the pixels, for windows and programs that show them.
///
/// # Errors
/// The errors of [`png()`].
pub fn pixels(world: &World, options: &PictureOptions) -> Result<Pixels, PictureError> {
    pixels::render(&svg(world, options)?, options.pixel_ratio)
}
