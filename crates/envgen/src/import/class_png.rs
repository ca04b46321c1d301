//! PNG images whose pixels are the classes of cells.

use std::io::Read;

use glam::DVec2;
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

use super::raster::{CellValues, ImportedRaster, RasterFileError, check_size};
use crate::export::class_png::CELL_KEY;
use crate::file::{self, PICTURE_KEY};

/// Reads an image as classes: the index of an indexed image, the grey of a grey image, and the colour of any other
/// image as the number `0xRRGGBB`. Transparent pixels are no data. A cell has a side of 1 m unless the image gives
/// another one.
///
/// # Errors
/// When the file is not a PNG image, or when it has too many pixels.
pub fn read_class_png(input: &mut dyn Read) -> Result<ImportedRaster, RasterFileError> {
    let bytes = file::read_bytes(input)?;
    let mut decoder = Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(Transformations::IDENTITY);
    // Memory for MAX_CELLS pixels of the widest kind; checked against the header before it is used.
    decoder.set_limits(Limits { bytes: 1 << 30 });
    // It may be compressed and large, and no colour is converted.
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info()?;
    let (rows, cols) = (u64::from(header.height), u64::from(header.width));
    check_size(rows, cols)?;
    let mut reader = decoder.read_info()?;
    let size = reader.output_buffer_size().ok_or(RasterFileError::Size { rows, cols })?;
    let mut data = vec![0; size];
    reader.next_frame(&mut data)?;
    let info = reader.info();
    let clear = info.trns.as_deref();
    let (color, depth) = (info.color_type, info.bit_depth);
    if info.uncompressed_latin1_text.iter().any(|chunk| chunk.keyword == PICTURE_KEY) {
        return Err(RasterFileError::Picture);
    }
    let cell = info
        .uncompressed_latin1_text
        .iter()
        .find(|chunk| chunk.keyword == CELL_KEY)
        .and_then(|chunk| chunk.text.parse::<f64>().ok())
        .filter(|cell| cell.is_finite() && *cell > 0.0)
        .unwrap_or(1.0);

    let samples = color.samples();
    let bits = depth as usize;
    let line = (cols as usize * samples * bits).div_ceil(8);
    let mut values = CellValues::with_capacity((rows * cols) as usize);
    for row in data.chunks_exact(line) {
        let sample = |i: usize| match depth {
            BitDepth::Sixteen => i64::from(u16::from_be_bytes([row[2 * i], row[2 * i + 1]])),
            BitDepth::Eight => i64::from(row[i]),
            // The first pixel is in the upper bits.
            _ => {
                let at = i * bits;
                i64::from(row[at / 8] >> (8 - bits - at % 8)) & ((1 << bits) - 1)
            }
        };
        for c in 0..cols as usize {
            values.push(pixel(color, bits, clear, |k| sample(c * samples + k)))?;
        }
    }
    ImportedRaster::new(rows, cols, cell, DVec2::ZERO, values)
}

/// Returns the class of a pixel with the given samples; `None` if it is transparent.
fn pixel(
    color: ColorType,
    bits: usize,
    clear: Option<&[u8]>,
    sample: impl Fn(usize) -> i64,
) -> Option<i64> {
    // The crate keeps one byte of each transparent sample where samples have 8 bits or less.
    let clear_sample = |k: usize| {
        if bits < 16 {
            return clear?.get(k).map(|&byte| i64::from(byte));
        }
        let pair = clear?.get(2 * k..2 * k + 2)?;
        Some(i64::from(u16::from_be_bytes([pair[0], pair[1]])))
    };
    let colour = || {
        let width = if bits == 16 { 16 } else { 8 };
        sample(0) << (2 * width) | sample(1) << width | sample(2)
    };
    match color {
        ColorType::Indexed => {
            let alpha = clear.and_then(|alphas| alphas.get(sample(0) as usize).copied());
            (alpha != Some(0)).then(|| sample(0))
        }
        ColorType::Grayscale => (clear_sample(0) != Some(sample(0))).then(|| sample(0)),
        ColorType::GrayscaleAlpha => (sample(1) != 0).then(|| sample(0)),
        ColorType::Rgb => {
            let transparent = (0..3).all(|k| clear_sample(k) == Some(sample(k)));
            (!transparent).then(colour)
        }
        ColorType::Rgba => (sample(3) != 0).then(colour),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode(
        (color, depth): (ColorType, BitDepth),
        (width, height): (u32, u32),
        trns: Option<Vec<u8>>,
        data: &[u8],
    ) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![0; 3 * 16]);
        }
        if let Some(trns) = trns {
            encoder.set_trns(trns);
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        file
    }

    fn read(file: &[u8]) -> ImportedRaster {
        read_class_png(&mut &*file).unwrap()
    }

    #[test]
    fn every_kind_of_image_is_read() {
        let grey = (ColorType::Grayscale, BitDepth::Eight);
        let found = read(&encode(grey, (3, 1), Some(vec![0, 9]), &[1, 9, 200]));
        assert_eq!((found.raster.cells, found.labels), (vec![1, 0, 200], None));

        let bits = (ColorType::Grayscale, BitDepth::One);
        let found = read(&encode(bits, (3, 2), None, &[0b1010_0000, 0b0110_0000]));
        assert_eq!(found.raster.cells, [2, 1, 2, 1, 2, 2]);
        assert_eq!(found.labels, Some(vec![0, 1]));

        let indexed = (ColorType::Indexed, BitDepth::Four);
        let found = read(&encode(indexed, (3, 1), Some(vec![255, 0]), &[0x31, 0x20]));
        assert_eq!(found.raster.cells, [3, 0, 2]);

        let colours = (ColorType::Rgba, BitDepth::Eight);
        let data = [1, 2, 3, 255, 0, 0, 0, 255, 9, 9, 9, 0];
        let found = read(&encode(colours, (3, 1), None, &data));
        assert_eq!(found.raster.cells, [2, 1, 0]);
        assert_eq!(found.labels, Some(vec![0, 0x01_02_03]));

        let colours = (ColorType::Rgb, BitDepth::Sixteen);
        let found = read(&encode(colours, (2, 1), None, &[1, 0, 2, 0, 3, 0, 1, 1, 2, 0, 3, 0]));
        assert_eq!(found.labels, Some(vec![0x0100_0200_0300, 0x0101_0200_0300]));
        assert_eq!(found.raster.cells, [1, 2]);
    }

    #[test]
    fn broken_images_are_errors() {
        let grey = (ColorType::Grayscale, BitDepth::Eight);
        let file = encode(grey, (3, 1), None, &[1, 2, 3]);
        for end in 0..file.len() - 20 {
            assert!(read_class_png(&mut &file[..end]).is_err(), "{end} bytes");
        }
        // A header that claims a billion rows and columns.
        let mut vast = file;
        vast[16..24].copy_from_slice(&[0x3b, 0x9a, 0xca, 0, 0x3b, 0x9a, 0xca, 0]);
        assert!(read_class_png(&mut vast.as_slice()).is_err());
    }
}
