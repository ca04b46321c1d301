//! The pixels of a captured image, in memory and as a PNG file.

use std::io::BufWriter;
use std::path::Path;

use bevy::prelude::*;

use crate::error::CaptureError;
use crate::whole_file;

/// An image that was captured, as red, green and blue values without alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CapturedImage {
    size: UVec2,
    rgb: Vec<u8>,
}

impl CapturedImage {
    /// Copies the pixels of an image that Bevy has drawn into.
    ///
    /// # Errors
    /// Returns an error if the format of the image is none of `Rgba8UnormSrgb`, `Bgra8UnormSrgb`, `Bgra8Unorm`,
    /// `Rg8Unorm` and `R8Unorm`.
    pub fn of(image: &Image) -> Result<Self, CaptureError> {
        Self::averaged(image, 1)
    }

    /// Scales an image down: each pixel is the mean of a square of `side` by `side` pixels.
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

    /// Returns the width and the height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Returns the red, green and blue values of all pixels, row by row from the top left.
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Returns the red, green and blue values of a pixel, counted from the top left, or `None` outside of the
    /// picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        if x >= self.size.x || y >= self.size.y {
            return None;
        }
        let first = 3 * (y as usize * self.size.x as usize + x as usize);
        self.rgb.get(first..first + 3)?.try_into().ok()
    }

    /// Writes a PNG file. The file appears completely or not at all.
    ///
    /// # Errors
    /// Returns an error if the file system reports one.
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
