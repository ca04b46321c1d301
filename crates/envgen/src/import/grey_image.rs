//! Grey images from PGM and PNG files.
//!
//! PGM is parsed here, not by the crate `image`, whose version 0.25.10 differs in points that matter for maps:
//!
//! - It scales greys to 8 or 16 bits: 50 of 100 becomes 128 of 255, so that cells change at thresholds.
//! - It accepts pixels above the greatest value, data after the last pixel, and images without pixels.
//! - It refuses comments between the pixels of P2, which Netpbm allows.
//! - Its `Limits` bound sides and memory, but not the number of pixels, and the memory is allocated before
//!   the data is seen: a P2 file of 17 bytes makes it allocate 256 MiB.
//! - Its errors name neither the field of the header nor the value.
//!
//! PNG is read by the crate `png`, on which `image` depends too.

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use thiserror::Error;

use crate::export::ros_map::MAX_CELLS;

/// The reasons why an image cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The format of the image is not supported.
    #[error("neither a PGM image (P2 or P5) nor a PNG image")]
    Format,
    /// A field of the PGM's header is not allowed.
    #[error("`{field}` of the PGM header must be {allowed}, got {value}")]
    Header {
        /// The name of the field: width, height or greatest value.
        field: &'static str,
        /// The value in the file.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// There are no pixels, or too many.
    #[error("the image must have from 1 to {MAX_CELLS} pixels, got {width} x {height}")]
    Size {
        /// Number of columns.
        width: u64,
        /// Number of rows.
        height: u64,
    },
    /// The PGM contains more or less data than its header states.
    #[error("the PGM must hold {expected} {unit} by its header, got {found}")]
    Length {
        /// The amount that the header states.
        expected: u64,
        /// The amount in the file.
        found: u64,
        /// The unit of these amounts: bytes or numbers.
        unit: &'static str,
    },
    /// A value of the PGM is not a number, or it is above the greatest value.
    #[error("pixel {pixel} of the PGM must be from 0 to {greatest}, got {value}")]
    Value {
        /// The index of the pixel, counted from 0 row by row from the top.
        pixel: u64,
        /// The value in the file.
        value: String,
        /// The greatest value in the header.
        greatest: u32,
    },
    /// The PNG is invalid.
    #[error("not a PNG image: {0}")]
    Png(#[from] png::DecodingError),
}

/// The shade of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shade {
    /// Mean of red, green and blue, from 0 (black) to 1 (white).
    pub(super) colour: f64,
    /// Opacity from 0 (transparent) to 1; absent if the image has no transparency at all.
    pub(super) alpha: Option<f64>,
}

/// What the pixels of an image stand for, row by row from the top.
#[derive(Debug)]
pub(super) struct GreyImage<T> {
    pub(super) cols: usize,
    pub(super) pixels: Vec<T>,
}

/// Reads an image in the format that its first bytes indicate. `of` converts each shade at once, since a shade
/// takes much more memory than what most readers make of it.
pub(super) fn read_image<T>(
    bytes: &[u8],
    of: impl Fn(Shade) -> T,
) -> Result<GreyImage<T>, ImageError> {
    match bytes {
        [b'P', kind @ (b'2' | b'5'), rest @ ..] => read_pgm(*kind == b'5', rest, of),
        [0x89, b'P', b'N', b'G', ..] => read_png(bytes, of),
        _ => Err(ImageError::Format),
    }
}

fn check_size(width: u64, height: u64) -> Result<(), ImageError> {
    match width.checked_mul(height) {
        Some(1..=MAX_CELLS) => Ok(()),
        _ => Err(ImageError::Size { width, height }),
    }
}

fn read_pgm<T>(
    binary: bool,
    bytes: &[u8],
    of: impl Fn(Shade) -> T,
) -> Result<GreyImage<T>, ImageError> {
    let mut rest = bytes;
    let mut number = |field, allowed: &str| {
        let word = next_word(&mut rest);
        let value = || String::from_utf8_lossy(&word[..word.len().min(20)]).into_owned();
        let header = || ImageError::Header { field, value: value(), allowed: allowed.to_owned() };
        std::str::from_utf8(word).ok().and_then(|w| w.parse::<u64>().ok()).ok_or_else(header)
    };
    let width = number("width", "a whole number")?;
    let height = number("height", "a whole number")?;
    check_size(width, height)?;
    let allowed = "from 1 to 65535";
    let greatest = number("maxval", allowed)?;
    if !(1..=65_535).contains(&greatest) {
        let (field, value) = ("maxval", greatest.to_string());
        return Err(ImageError::Header { field, value, allowed: allowed.to_owned() });
    }
    let (pixels, greatest) = (width * height, greatest as u32);
    let pixel_of = |pixel: u64, value: u32| {
        if value > greatest {
            return Err(ImageError::Value { pixel, value: value.to_string(), greatest });
        }
        Ok(of(Shade { colour: f64::from(value) / f64::from(greatest), alpha: None }))
    };
    let converted: Result<Vec<T>, ImageError> = if binary {
        // One white space ends the header; anything after it is a pixel.
        let data = rest.get(1..).unwrap_or_default();
        let wide = if greatest > 255 { 2 } else { 1 };
        let (expected, found) = (pixels * wide, data.len() as u64);
        let tail = data.get(expected as usize..).unwrap_or_default();
        if found < expected || !tail.iter().all(u8::is_ascii_whitespace) {
            return Err(ImageError::Length { expected, found, unit: "bytes of pixels" });
        }
        let value = |bytes: &[u8]| bytes.iter().fold(0, |v, &byte| v << 8 | u32::from(byte));
        let data = data[..expected as usize].chunks_exact(wide as usize);
        (0..).zip(data).map(|(pixel, bytes)| pixel_of(pixel, value(bytes))).collect()
    } else {
        // At least a digit and a space each: a false header allocates nothing.
        let most = (rest.len() as u64).min(pixels);
        let mut converted = Vec::with_capacity(most as usize);
        let mut found = 0;
        loop {
            let word = next_word(&mut rest);
            if word.is_empty() {
                break;
            }
            if found < pixels {
                let text = String::from_utf8_lossy(&word[..word.len().min(20)]);
                let value = text.parse::<u32>().map_err(|_| ImageError::Value {
                    pixel: found,
                    value: text.clone().into_owned(),
                    greatest,
                })?;
                converted.push(pixel_of(found, value)?);
            }
            found += 1;
        }
        if found != pixels {
            return Err(ImageError::Length { expected: pixels, found, unit: "numbers" });
        }
        Ok(converted)
    };
    Ok(GreyImage { cols: width as usize, pixels: converted? })
}

/// Returns the next word, skipping white space and comments before it; empty at the end.
fn next_word<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    loop {
        let blank = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        *rest = &rest[blank..];
        if rest.first() != Some(&b'#') {
            break;
        }
        let line = rest.iter().take_while(|byte| !matches!(byte, b'\n' | b'\r')).count();
        *rest = &rest[line..];
    }
    let ends = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'#';
    let length = rest.iter().take_while(|byte| !ends(byte)).count();
    let (word, after) = rest.split_at(length);
    *rest = after;
    word
}

fn read_png<T>(bytes: &[u8], of: impl Fn(Shade) -> T) -> Result<GreyImage<T>, ImageError> {
    let mut decoder = Decoder::new(std::io::Cursor::new(bytes));
    // Palettes, few bits and transparent colours become plain 8 bits; 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_limits(Limits { bytes: 1 << 30 });
    // It may be compressed and large, and no colour is converted.
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info()?;
    let (width, height) = (u64::from(header.width), u64::from(header.height));
    check_size(width, height)?;
    let mut reader = decoder.read_info()?;
    let size = reader.output_buffer_size().ok_or(ImageError::Size { width, height })?;
    let mut data = vec![0; size];
    reader.next_frame(&mut data)?;
    let (color, depth) = reader.output_color_type();
    let samples = match color {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb | ColorType::Indexed => 3,
        ColorType::Rgba => 4,
    };
    let bytes = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let shade = |pixel: &[u8]| {
        let value = |sample: &[u8]| match *sample {
            [high, low] => f64::from(u16::from_be_bytes([high, low])) / 65535.0,
            _ => f64::from(sample[0]) / 255.0,
        };
        let (colours, alpha) = pixel.split_at(if samples < 3 { bytes } else { 3 * bytes });
        let count = (colours.len() / bytes) as f64;
        let colour = colours.chunks_exact(bytes).map(value).sum::<f64>() / count;
        Shade { colour, alpha: alpha.chunks_exact(bytes).next().map(value) }
    };
    let pixels = data.chunks_exact(samples * bytes).take((width * height) as usize);
    Ok(GreyImage { cols: width as usize, pixels: pixels.map(|pixel| of(shade(pixel))).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greys(bytes: &[u8]) -> Result<Vec<u16>, String> {
        let grey = |shade: Shade| (shade.colour * 1000.0).round() as u16;
        read_image(bytes, grey).map(|image| image.pixels).map_err(|error| error.to_string())
    }

    #[test]
    fn every_kind_of_pgm_is_read() {
        let expected = Ok(vec![0, 1000, 200, 1000]);
        assert_eq!(greys(b"P2\n2 2\n5\n0 5\n1 5\n"), expected);
        assert_eq!(greys(b"P2 # by hand\n# 2 x 2\n2 2 5 0 5 # half\n1 5"), expected);
        assert_eq!(greys(b"P5\n2 2\n255\n\x00\xff\x33\xff"), expected);
        assert_eq!(greys(b"P5\n# CREATOR: map_saver\n2 2\n255\n\x00\xff\x33\xff\n"), expected);
        assert_eq!(greys(b"P5 2 2 65535 \x00\x00\xff\xff\x33\x33\xff\xff"), expected);
        // The first pixel may look like white space or a comment.
        assert_eq!(greys(b"P5 3 1 255\n\n#\x00"), Ok(vec![39, 137, 0]));
    }

    #[test]
    fn what_is_wrong_with_a_pgm_is_named() {
        for (bytes, what) in [
            (&b"P6\n1 1\n255\n\x00\x00\x00"[..], "neither a PGM"),
            (b"", "neither a PGM"),
            (b"P5", "`width` of the PGM header must be a whole number, got "),
            (b"P5 2", "`height` of the PGM header must be a whole number, got "),
            (b"P5 -2 2 255 ", "`width` of the PGM header must be a whole number, got -2"),
            (b"P5 2 2.5 255 ", "`height` of the PGM header must be a whole number, got 2.5"),
            (b"P5 2 2 0 \x00\x00\x00\x00", "`maxval` of the PGM header must be from 1 to"),
            (
                b"P5 2 2 65536 \x00\x00\x00\x00",
                "`maxval` of the PGM header must be from 1 to 65535, got 65536",
            ),
            (b"P5 0 2 255 ", "pixels, got 0 x 2"),
            (b"P5 4294967296 4294967296 255 ", "pixels, got 4294967296 x 4294967296"),
            (b"P5 99999999 1 255 ", "pixels, got 99999999 x 1"),
            (b"P5 2 2 255 \x00\x00\x00", "must hold 4 bytes of pixels by its header, got 3"),
            (b"P5 2 2 256 \x00\x00\x00\x00", "must hold 8 bytes of pixels by its header, got 4"),
            (b"P5 2 1 255 \x00\x00\x00", "must hold 2 bytes of pixels by its header, got 3"),
            (b"P5 2 1 200 \x00\xc9", "pixel 1 of the PGM must be from 0 to 200, got 201"),
            (b"P2 2 1 9 1", "must hold 2 numbers by its header, got 1"),
            (b"P2 2 1 9 1 2 3", "must hold 2 numbers by its header, got 3"),
            (b"P2 8000 8000 9 1", "must hold 64000000 numbers by its header, got 1"),
            (b"P2 2 1 9 1 x", "pixel 1 of the PGM must be from 0 to 9, got x"),
            (b"P2 2 1 9 1 10", "pixel 1 of the PGM must be from 0 to 9, got 10"),
            (b"P2 2 1 9 1 NaN", "pixel 1 of the PGM must be from 0 to 9, got NaN"),
        ] {
            let error = greys(bytes).unwrap_err();
            assert!(error.contains(what), "{}: {error}", String::from_utf8_lossy(bytes));
        }
    }

    #[test]
    fn a_png_has_colours_and_transparency() {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 2, 1);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Sixteen);
        let mut writer = encoder.write_header().unwrap();
        let pixels = [255, 255, 0, 0, 0, 0, 255, 255, 0, 3, 0, 0, 0, 0, 0, 0];
        writer.write_image_data(&pixels).unwrap();
        writer.finish().unwrap();
        let image = read_image(&file, |shade| shade).unwrap();
        assert_eq!(image.pixels[0], Shade { colour: 1.0 / 3.0, alpha: Some(1.0) });
        assert_eq!(image.pixels[1], Shade { colour: 1.0 / 65535.0, alpha: Some(0.0) });
        for end in 0..file.len() - 12 {
            assert!(read_image(&file[..end], |_| ()).is_err(), "{end} bytes");
        }
        file[16..24].copy_from_slice(&[0x3b, 0x9a, 0xca, 0, 0x3b, 0x9a, 0xca, 0]);
        assert!(read_image(&file, |_| ()).is_err());
    }
}
