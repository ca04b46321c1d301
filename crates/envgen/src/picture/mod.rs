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
