//! Folders with the pictures of cameras, for other programs.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use envgen::whole_file::WholeFile;
use serde_json::{Value, json};

use super::frame::CameraFrame;
use super::labels::Labels;
use super::settings::RobotCamera;

/// The number of metres per unit of the depth images.
pub const DEPTH_UNIT: f64 = 1e-3;

/// The label in 16-bit images of everything whose label does not fit into 16 bits.
pub const OTHER_LABEL: u16 = u16::MAX;

/// The number of pictures after which the description is written again, so that little is lost if the program is
/// killed. A long description is written again once it has grown by a quarter, since all of it is written.
const FRAMES_A_SAVE: usize = 50;

/// The name of the file with the description.
const DESCRIPTION: &str = "frames.json";

/// A folder with the pictures of one camera: `rgb/000001.png` with 8 bits per colour, `depth/000001.png` in
/// millimetres, `labels/000001.png` with 16 bits, and the description `frames.json`. The guide documents the
/// format.
#[derive(Debug)]
pub struct CameraFolder {
    folder: PathBuf,
    camera: RobotCamera,
    frames: Vec<Value>,
    /// The number of pictures at which the description is written again.
    next_save: usize,
    /// The descriptions of the labels that occurred.
    labels: BTreeMap<u16, Value>,
    /// The constant part of the description.
    head: serde_json::Map<String, Value>,
}

impl CameraFolder {
    /// Starts a recording in a folder, which is created if necessary. The pictures of an earlier recording in
    /// it are removed.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created or written to.
    pub fn create(folder: impl Into<PathBuf>, camera: RobotCamera) -> io::Result<Self> {
        let folder = folder.into();
        let is_earlier = folder.join(DESCRIPTION).is_file();
        fs::create_dir_all(&folder)?;
        let new = CameraFolder {
            folder,
            camera,
            frames: Vec::new(),
            next_save: FRAMES_A_SAVE,
            labels: BTreeMap::new(),
            head: serde_json::Map::new(),
        };
        // The earlier description is replaced first: it must not name pictures that are removed.
        new.save()?;
        for (name, is_taken) in images(&new.camera) {
            let images = new.folder.join(name);
            if is_earlier && images.is_dir() {
                remove_pictures(&images)?;
            }
            if is_taken {
                fs::create_dir_all(images)?;
            }
        }
        Ok(new)
    }

    /// Writes the images of a picture.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub fn push(&mut self, frame: &CameraFrame) -> io::Result<()> {
        let (width, height) = (frame.optics.width, frame.optics.height);
        let name = format!("{:06}.png", self.frames.len() + 1);
        let mut entry = serde_json::Map::new();
        let mut write = |kind: &str, key: &str, format, data: &[u8]| -> io::Result<()> {
            let path = format!("{kind}/{name}");
            write_png(&self.folder.join(&path), [width, height], format, data)?;
            entry.insert(key.to_owned(), path.into());
            Ok(())
        };
        let eight = (png::ColorType::Rgb, png::BitDepth::Eight);
        let sixteen = (png::ColorType::Grayscale, png::BitDepth::Sixteen);
        if let Some(color) = &frame.color {
            write("rgb", "file_path", eight, color)?;
        }
        if let Some(depth) = &frame.depth {
            let data: Vec<u8> =
                depth.iter().flat_map(|&depth| units(depth).to_be_bytes()).collect();
            write("depth", "depth_file_path", sixteen, &data)?;
        }
        if let Some(labels) = &frame.labels {
            let data: Vec<u8> =
                labels.iter().flat_map(|&label| short(label).to_be_bytes()).collect();
            write("labels", "label_file_path", sixteen, &data)?;
            let mut last = None;
            for &label in labels {
                // Neighbouring pixels mostly have the same label.
                if last.replace(label) == Some(label) {
                    continue;
                }
                self.labels.entry(short(label)).or_insert_with(|| describe(label, &frame.names));
            }
        }
        let position = frame.pose.position;
        let axes = frame.pose.axes.to_cols_array_2d();
        let orientation = frame.pose.orientation();
        let row = |i: usize| [axes[0][i], axes[1][i], axes[2][i], position[i]];
        entry.insert("time".into(), frame.time.into());
        entry.insert("position".into(), json!(position.to_array()));
        entry.insert("orientation".into(), json!(orientation.to_array()));
        entry.insert(
            "transform_matrix".into(),
            json!([row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]),
        );
        self.frames.push(entry.into());
        if self.head.is_empty() {
            self.head = head(frame);
        }
        if self.frames.len() < self.next_save {
            return Ok(());
        }
        self.next_save += FRAMES_A_SAVE.max(self.frames.len() / 4);
        self.save()
    }

    /// Writes the complete description, and returns its path.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn finish(self) -> io::Result<PathBuf> {
        self.save()?;
        Ok(self.folder.join(DESCRIPTION))
    }

    /// Returns the number of pictures so far.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Returns whether there are no pictures yet.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    fn save(&self) -> io::Result<()> {
        let mut all = self.head.clone();
        let RobotCamera { forward, left, up, pitch, yaw, field_of_view, rate, .. } = self.camera;
        all.insert(
            "camera".into(),
            json!({
                "forward": forward, "left": left, "up": up, "pitch": pitch, "yaw": yaw,
                "field_of_view": field_of_view, "rate": rate,
            }),
        );
        all.insert("frames".into(), self.frames.clone().into());
        all.insert("labels".into(), self.labels.values().cloned().collect());
        let mut text = serde_json::to_vec_pretty(&all)?;
        text.push(b'\n');
        let mut file = WholeFile::create(&self.folder.join(DESCRIPTION))?;
        file.write_all(&text)?;
        file.commit()
    }
}

/// Returns the names of the folders of images, and whether the camera takes these images.
fn images(camera: &RobotCamera) -> [(&'static str, bool); 3] {
    let images = camera.images;
    [("rgb", images.color), ("depth", images.depth), ("labels", images.labels)]
}

/// Removes the pictures that a recording has written, and nothing else.
fn remove_pictures(folder: &Path) -> io::Result<()> {
    for file in fs::read_dir(folder)? {
        let path = file?.path();
        let is_number = |name: &str| name.len() >= 6 && name.bytes().all(|b| b.is_ascii_digit());
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        if stem.is_some_and(is_number) && path.extension().is_some_and(|ending| ending == "png") {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

/// Returns the optics, with the names that programs for radiance fields use, and the unit of depth.
fn head(frame: &CameraFrame) -> serde_json::Map<String, Value> {
    let optics = frame.optics;
    let (center, focal) = (optics.center(), optics.focal_length);
    let json = json!({
        "camera_model": "PINHOLE",
        "w": optics.width, "h": optics.height,
        "fl_x": focal, "fl_y": focal, "cx": center.x, "cy": center.y,
        "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0,
        "depth_unit_scale_factor": DEPTH_UNIT,
        "integer_depth_scale": DEPTH_UNIT,
    });
    match json {
        Value::Object(fields) => fields,
        _ => unreachable!("braces make an object"),
    }
}

/// Converts a depth to millimetres. It is 0 if there is no surface, or if the depth does not fit.
fn units(depth: f32) -> u16 {
    let units = (f64::from(depth) / DEPTH_UNIT).round();
    if units < f64::from(u16::MAX) { (units as u16).max(1) } else { 0 }
}

fn short(label: u32) -> u16 {
    u16::try_from(label).unwrap_or(OTHER_LABEL)
}

fn describe(label: u32, names: &Labels) -> Value {
    let (kind, name) = match (label, names.get(label)) {
        (OTHER.., _) => ("other".to_owned(), "other".to_owned()),
        (_, Some(label)) => (label.kind, label.name),
        (_, None) => ("none".to_owned(), "none".to_owned()),
    };
    json!({ "id": short(label), "kind": kind, "name": name })
}

/// Labels from [`OTHER_LABEL`] upwards.
const OTHER: u32 = OTHER_LABEL as u32;

fn write_png(
    path: &Path,
    [width, height]: [u32; 2],
    (color, depth): (png::ColorType, png::BitDepth),
    data: &[u8],
) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Fast);
    if color == png::ColorType::Rgb {
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    }
    let mut writer = encoder.write_header().map_err(io::Error::from)?;
    writer.write_image_data(data).map_err(io::Error::from)?;
    writer.finish().map_err(io::Error::from)?;
    file.flush()
}
