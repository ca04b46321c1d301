//! A captured image in memory, and as PNG.

use std::io::BufWriter;
use std::path::Path;

use bevy::prelude::*;

use crate::error::CaptureError;
use crate::whole_file;

/// Pixels in red, green and blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CapturedImage {
    size: UVec2,
    rgb: Vec<u8>,
}

impl CapturedImage {
    /// The pixels of an image that Bevy drew into.
    ///
    /// # Errors
    /// A format without colours.
    pub fn of(image: &Image) -> Result<Self, CaptureError> {
        Self::averaged(image, 1)
    }

    /// The means of squares of pixels, `side` wide.
    pub(crate) fn averaged(image: &Image, side: u32) -> Result<Self, CaptureError> {
        let format =
            || CaptureError::Format { format: format!("{:?}", image.texture_descriptor.format) };
        let drawn = image.clone().try_into_dynamic().map_err(|_| format())?;
        let pixels = match side {
            1 => drawn,
            side => drawn.thumbnail_exact(drawn.width() / side, drawn.height() / side),
        };
        let size = UVec2::new(pixels.width(), pixels.height());
        Ok(CapturedImage { size, rgb: pixels.into_rgb8().into_raw() })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Red, green and blue of every pixel, row by row from the top left.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Red, green and blue of a pixel, counted from the top left; `None` outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        if x >= self.size.x || y >= self.size.y {
            return None;
        }
        let first = 3 * (y as usize * self.size.x as usize + x as usize);
        self.rgb.get(first..first + 3)?.try_into().ok()
    }

    /// Writes a PNG, which appears completely or not at all.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), CaptureError> {
        let path = path.as_ref();
        self.write(path).map_err(|source| CaptureError::File { path: path.to_owned(), source })
    }

    fn write(&self, path: &Path) -> std::io::Result<()> {
        let mut out = BufWriter::new(whole_file::create(path)?);
        let mut encoder = png::Encoder::new(&mut out, self.size.x, self.size.y);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()?;
        out.into_inner()?.commit()
    }
}
