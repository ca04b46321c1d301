//! Sequences of pictures, as an animated GIF or as a folder of PNG files.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use atomic_write_file::AtomicWriteFile;
use bevy::prelude::*;
use gif::{Encoder, Frame, Repeat};

use crate::captured_image::CapturedImage;
use crate::error::CaptureError;
use crate::whole_file;

/// An animated GIF that loops forever.
///
/// Each frame is written when it is added: only the area that has changed, with a palette of its own. Up to
/// 256 colours are exact, and more are replaced by the nearest colours of the palette. The file appears when
/// [`Film::finish`] is called. Without that call no file is written.
///
/// ```
/// use bevy_offscreen::Film;
/// # use bevy::image::Image;
/// # use bevy_offscreen::CapturedImage;
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("film.gif");
/// # let image = Image::default();
/// # let picture = CapturedImage::of(&image)?;
/// let mut film = Film::create(&path, 10.0)?;
/// film.push(&picture)?;
/// film.finish()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Film {
    path: PathBuf,
    /// The time from frame to frame in hundredths of a second.
    delay: u16,
    /// The open file, until the first frame defines the size of the film.
    file: Option<BufWriter<AtomicWriteFile>>,
    encoder: Option<Encoder<BufWriter<AtomicWriteFile>>>,
    last: Option<CapturedImage>,
    /// How long the last picture must still be shown, in hundredths of a second.
    waiting: u16,
}

impl Film {
    /// Creates a film of `frames_per_second` frames per second, from 1 to 50. GIF stores the duration of a
    /// frame in hundredths of a second, to which it is rounded.
    ///
    /// # Errors
    /// Returns an error if the frame rate is out of range, or if the file cannot be created.
    pub fn create(path: impl Into<PathBuf>, frames_per_second: f64) -> Result<Self, CaptureError> {
        if !(1.0..=50.0).contains(&frames_per_second) {
            return Err(CaptureError::FrameRate { found: frames_per_second });
        }
        let path = path.into();
        let error = |source| CaptureError::File { path: path.clone(), source };
        let file = BufWriter::new(whole_file::create(&path).map_err(error)?);
        let delay = (100.0 / frames_per_second).round() as u16;
        Ok(Film { path, delay, file: Some(file), encoder: None, last: None, waiting: 0 })
    }

    /// Adds a picture. If it is equal to the last one, the last one is shown longer instead.
    ///
    /// # Errors
    /// Returns an error if the size differs from that of the film, if a side has no pixels or is longer than
    /// 65,535 pixels, or if the file system reports an error.
    pub fn push(&mut self, picture: &CapturedImage) -> Result<(), CaptureError> {
        let size = picture.size();
        let sides = u16::try_from(size.x).ok().zip(u16::try_from(size.y).ok());
        let Some((width, height)) = sides.filter(|&(width, height)| width > 0 && height > 0) else {
            return Err(CaptureError::Size {
                width: size.x,
                height: size.y,
                largest: u16::MAX.into(),
            });
        };
        if let Some(file) = self.file.take() {
            let mut encoder = Encoder::new(file, width, height, &[])
                .map_err(|error| failure(&self.path, error))?;
            encoder.set_repeat(Repeat::Infinite).map_err(|error| failure(&self.path, error))?;
            self.encoder = Some(encoder);
        }
        let mut area = URect::from_corners(UVec2::ZERO, size);
        if let Some(last) = &self.last {
            if last.size() != size {
                return Err(CaptureError::OtherSize { found: size, expected: last.size() });
            }
            let Some(changed) = changes(last, picture) else {
                if self.waiting > u16::MAX - self.delay {
                    self.hold()?;
                }
                self.waiting += self.delay;
                return Ok(());
            };
            area = changed;
        }
        self.hold()?;
        if let Some(encoder) = &mut self.encoder {
            let mut pixels = Vec::new();
            for y in area.min.y..area.max.y {
                let row = y as usize * size.x as usize;
                let (from, to) = (row + area.min.x as usize, row + area.max.x as usize);
                pixels.extend_from_slice(&picture.rgb()[3 * from..3 * to]);
            }
            // Within the sizes that were checked above.
            let [left, top] = area.min.to_array().map(|side| side as u16);
            let [width, height] = area.size().to_array().map(|side| side as u16);
            let mut frame = Frame::from_rgb_speed(width, height, &pixels, 10);
            (frame.left, frame.top, frame.delay) = (left, top, self.delay);
            encoder.write_frame(&frame).map_err(|error| failure(&self.path, error))?;
        }
        self.last = Some(picture.clone());
        Ok(())
    }

    /// Extends the time for which the last picture is shown, with a frame of a single pixel.
    fn hold(&mut self) -> Result<(), CaptureError> {
        let waiting = std::mem::take(&mut self.waiting);
        if let (1.., Some(encoder), Some(last)) = (waiting, &mut self.encoder, &self.last) {
            let mut frame = Frame::from_rgb_speed(1, 1, &last.rgb()[..3], 10);
            frame.delay = waiting;
            encoder.write_frame(&frame).map_err(|error| failure(&self.path, error))?;
        }
        Ok(())
    }

    /// Writes the remaining data and gives the file its name. A film without frames creates no file.
    ///
    /// # Errors
    /// Returns an error if the file system reports one.
    pub fn finish(mut self) -> Result<(), CaptureError> {
        self.hold()?;
        let Some(encoder) = self.encoder else {
            return Ok(());
        };
        let path = self.path;
        let finish = || {
            let mut out = encoder.into_inner().map_err(std::io::Error::other)?;
            out.flush()?;
            out.into_inner().map_err(std::io::IntoInnerError::into_error)?.commit()
        };
        finish().map_err(|source| CaptureError::File { path: path.clone(), source })
    }
}

fn failure(path: &Path, error: gif::EncodingError) -> CaptureError {
    let source = match error {
        gif::EncodingError::Io(source) => source,
        other => std::io::Error::other(other),
    };
    CaptureError::File { path: path.to_owned(), source }
}

/// Returns the smallest rectangle around all pixels that differ, or `None` if the images are equal.
fn changes(a: &CapturedImage, b: &CapturedImage) -> Option<URect> {
    let width = a.size().x as usize;
    let pixels = a.rgb().as_chunks::<3>().0.iter().zip(b.rgb().as_chunks::<3>().0);
    let mut area: Option<URect> = None;
    for (i, _) in pixels.enumerate().filter(|(_, (a, b))| a != b) {
        let at = UVec2::new((i % width) as u32, (i / width) as u32);
        let pixel = URect::from_corners(at, at + UVec2::ONE);
        area = Some(area.map_or(pixel, |area| area.union(pixel)));
    }
    area
}

/// A folder of PNG files named `frame_000001.png` and so on, as video encoders read them.
#[derive(Debug)]
pub struct Frames {
    folder: PathBuf,
    count: u32,
}

impl Frames {
    /// Creates the folder if it does not exist. Existing frames in it are overwritten.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created.
    pub fn create(folder: impl Into<PathBuf>) -> Result<Self, CaptureError> {
        let folder = folder.into();
        match fs::create_dir_all(&folder) {
            Ok(()) => Ok(Frames { folder, count: 0 }),
            Err(source) => Err(CaptureError::File { path: folder, source }),
        }
    }

    /// Writes the next picture and returns its path.
    ///
    /// # Errors
    /// Returns an error if the file system reports one.
    pub fn push(&mut self, picture: &CapturedImage) -> Result<PathBuf, CaptureError> {
        let path = self.folder.join(format!("frame_{:06}.png", self.count + 1));
        picture.write_png(&path)?;
        self.count += 1;
        Ok(path)
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the number of frames that were written.
    pub fn count(&self) -> u32 {
        self.count
    }
}
