//! Rendering of SVG to pixels.

use std::io::Write;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg;

use super::error::{MAX_PIXELS, PictureError};
use crate::palette;

/// A picture in memory: red, green and blue of each pixel, with rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Three bytes per pixel.
    pub rgb: Vec<u8>,
}

/// Renders an SVG, whose background must be opaque, with `ratio` pixels per px.
pub(super) fn render(svg: &str, ratio: f64) -> Result<Pixels, PictureError> {
    let tree = usvg::Tree::from_str(svg, &usvg::Options::default())?;
    let pixels = |px: f32| (f64::from(px) * ratio).ceil().max(1.0) as u64;
    let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
    let too_large = PictureError::TooLarge { width, height };
    if width.saturating_mul(height) > MAX_PIXELS {
        return Err(too_large);
    }
    let (width, height) = (width as u32, height as u32);
    let Some(mut pixmap) = Pixmap::new(width, height) else { return Err(too_large) };
    // The picture may cover the last row and column in part.
    let [r, g, b] = palette::PAGE.0;
    pixmap.fill(Color::from_rgba8(r, g, b, u8::MAX));
    let ratio = ratio as f32;
    resvg::render(&tree, Transform::from_scale(ratio, ratio), &mut pixmap.as_mut());
    // In place: a copy of a large picture would need much memory.
    let mut rgb = pixmap.take();
    let count = rgb.len() / 4;
    for i in 0..count {
        rgb.copy_within(4 * i..4 * i + 3, 3 * i);
    }
    rgb.truncate(3 * count);
    Ok(Pixels { width, height, rgb })
}

impl Pixels {
    /// Writes the picture as a PNG file.
    pub(super) fn write(&self, out: &mut dyn Write) -> Result<(), PictureError> {
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        // Readers of classes from images recognise by it that this is a picture.
        encoder.add_text_chunk(
            crate::file::PICTURE_KEY.to_owned(),
            "a picture of a world".to_owned(),
        )?;
        let mut writer = encoder.write_header()?;
        let mut rows = writer.stream_writer()?;
        rows.write_all(&self.rgb)?;
        rows.finish()?;
        Ok(writer.finish()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_covered_in_part_have_the_colour_of_the_page() {
        let color = palette::PAGE;
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="11" height="11"><rect width="11" height="11" fill="{color}"/></svg>"#
        );
        let rendered = render(&svg, 0.75).unwrap();
        let mut file = Vec::new();
        rendered.write(&mut file).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!((rendered.width, rendered.height), (9, 9));
        assert_eq!(rendered.rgb, pixels);
        assert_eq!(pixels.len(), 3 * 9 * 9);
        assert!(pixels.chunks_exact(3).all(|pixel| pixel == color.0), "{pixels:?}");
    }
}
