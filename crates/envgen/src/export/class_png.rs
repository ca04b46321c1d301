//! PNG images whose pixels are the classes of cells.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Encoder, EncodingError};

use crate::palette::ordered_class;
use crate::world::ClassRaster;

/// The keyword of the text chunk that contains the side of a cell in metres.
pub const CELL_KEY: &str = "envgen cell m";

/// Writes the classes of a raster as an image with one pixel per cell. For up to 255 classes it is an indexed image
/// whose index is the class; for more it is a grey image of 16 bits whose grey is the class. No data is
/// transparent. Reading the file back with [`read_class_png`](crate::import::read_class_png) gives the same cells
/// and cell side.
///
/// ```
/// use envgen::export::class_png::write_class_png;
/// use envgen::import::read_class_png;
/// use envgen::{Seed, Spec, landscape::LandscapeSpec};
///
/// let raster = LandscapeSpec { cell_size: 2.0, ..Default::default() }.generate(Seed(7))?.to_raster();
/// let mut file = Vec::new();
/// write_class_png(&raster, &mut file)?;
/// let read = read_class_png(&mut file.as_slice())?.raster;
/// assert_eq!((read.cells, read.cell), (raster.cells, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When writing fails.
pub fn write_class_png(raster: &ClassRaster, out: &mut dyn Write) -> io::Result<()> {
    let most = raster.cells.iter().copied().max().unwrap_or(0);
    let mut encoder = Encoder::new(out, raster.cols, raster.rows);
    encoder.set_compression(png::Compression::Fast);
    let io = |error: EncodingError| match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    };
    encoder.add_text_chunk(CELL_KEY.to_owned(), raster.cell.to_string()).map_err(io)?;
    let data: Vec<u8> = if most <= 255 {
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_palette(
            (0..=most).flat_map(|class| ordered_class(class, most).0).collect::<Vec<_>>(),
        );
        encoder.set_trns(vec![0]);
        raster.cells.iter().map(|&class| class as u8).collect()
    } else {
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::Sixteen);
        encoder.set_trns(vec![0, 0]);
        raster.cells.iter().flat_map(|class| class.to_be_bytes()).collect()
    };
    let mut writer = encoder.write_header().map_err(io)?;
    writer.write_image_data(&data).map_err(io)?;
    writer.finish().map_err(io)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::read_class_png;
    use glam::DVec2;

    #[test]
    fn an_image_comes_back() {
        for most in [1, 2, 9, 255, 256, 65_535] {
            let raster = ClassRaster {
                rows: 2,
                cols: 3,
                cell: 0.1,
                origin: DVec2::ZERO,
                cells: vec![1, 0, most, most / 2, 1, 1],
                speeds: Vec::new(),
            };
            let mut file = Vec::new();
            write_class_png(&raster, &mut file).unwrap();
            let read = read_class_png(&mut file.as_slice()).unwrap();
            assert_eq!((read.raster, read.labels), (raster, None));
        }
    }
}
