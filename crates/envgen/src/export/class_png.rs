//! PNG images whose pixels are the classes of cells.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Encoder, EncodingError};

use crate::world::ClassRaster;

/// The text chunk that holds the side of a cell in metres.
pub const CELL_KEY: &str = "envgen cell m";

/// Writes the classes of a raster as an image with one pixel per cell: an indexed one, whose index is
/// the class, for up to 255 classes, and a grey one of 16 bits, whose grey is the class, for
/// more. No data is transparent. Reading it back with
/// [`read_class_png`](crate::import::read_class_png) gives the same cells and cell side.
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
        encoder.set_palette((0..=most).flat_map(|class| colour(class, most)).collect::<Vec<_>>());
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

/// Colours from dark blue over green to yellow, after matplotlib's viridis (CC0): their lightness
/// rises with the class, so that colour-blind people can distinguish them.
pub fn colour(class: u16, classes: u16) -> [u8; 3] {
    const VIRIDIS: [[f64; 3]; 9] = [
        [68.0, 1.0, 84.0],
        [71.0, 44.0, 122.0],
        [59.0, 81.0, 139.0],
        [44.0, 113.0, 142.0],
        [33.0, 144.0, 141.0],
        [39.0, 173.0, 129.0],
        [92.0, 200.0, 99.0],
        [170.0, 220.0, 50.0],
        [253.0, 231.0, 37.0],
    ];
    if class == 0 {
        return [0; 3];
    }
    let share = f64::from(class - 1) / f64::from(classes.max(2) - 1);
    let at = share.min(1.0) * 8.0;
    let (low, part) = (at.floor().min(7.0) as usize, at - at.floor().min(7.0));
    [0, 1, 2].map(|k| {
        let (a, b) = (VIRIDIS[low][k], VIRIDIS[low + 1][k]);
        (a + (b - a) * part).round() as u8
    })
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

    #[test]
    fn colours_differ() {
        let colours: std::collections::BTreeSet<_> = (0..=60).map(|k| colour(k, 60)).collect();
        assert_eq!(colours.len(), 61);
        assert_eq!(colour(1, 1), colour(1, 60));
    }
}
