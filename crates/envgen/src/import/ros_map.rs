//! Maps of ROS's `map_server` and Nav2 as worlds; [`export::ros_map`](crate::export::ros_map) describes the format.

mod yaml;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec2;
use serde::Deserialize;
use thiserror::Error;

pub use super::grey_image::ImageError;
use super::grey_image::{Shade, read_image};
use crate::error::SpecError;
use crate::export::ros_map::{RESOLUTIONS, RosCell, RosMap};
use crate::file::{self, FileError};
use crate::geometry::{Pose, Rect, Shape};
use crate::occupancy::OccupancyGrid;
use crate::placement::max_clearance_point;
use crate::provenance::IMPORT;
use crate::provenance::Provenance;
use crate::world::{MAX_COORDINATE, Obstacle, ObstacleKind, Wall, WallKind, World};

/// The greatest grey of a raw map that is a probability, in percent.
const MAX_PERCENT: f64 = 100.0;

/// The grey of unknown cells in maps that ROS and Nav2 save.
const SAVED_UNKNOWN: f64 = 205.0;

/// Cells that are smaller, in metres, are too fine for the distances of a start.
const FINE_CELLS: f64 = 0.01;

/// The least side in metres of the cells to which they are joined.
const COARSE_CELLS: f64 = 0.1;

/// The least share of pixels for [`unknown_cells_warning`].
const SUSPECT_SHARE: f64 = 0.01;

/// The greatest number of walls and obstacles of a world that is read from a map.
const MAX_BOXES: usize = 1 << 22;

/// The reasons why a map could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RosMapError {
    /// Reading the description failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The description is not the YAML of a map.
    #[error("not the YAML of a map: {0}")]
    Yaml(String),
    /// A value of the description is not allowed.
    #[error(transparent)]
    Value(#[from] SpecError),
    /// The image file cannot be read.
    #[error("`image` is {path}, which cannot be read: {error}")]
    Missing {
        /// The path of the image file.
        path: PathBuf,
        /// The cause.
        error: FileError,
    },
    /// The image is invalid.
    #[error("`image` is {path}: {error}")]
    Image {
        /// The path of the image file.
        path: PathBuf,
        /// The cause.
        error: ImageError,
    },
    /// The map has too many walls for a world.
    #[error(
        "the map has {found} walls and unknown areas, but a world has at most {MAX_BOXES}; filter single cells \
         out of the map"
    )]
    Boxes {
        /// Number of boxes of cells.
        found: usize,
    },
}

/// The conversion of greys into occupancy. Here p is the probability of occupancy, 1 for black and 0 for white, or
/// the reverse if the map has `negate` set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RosMode {
    /// A cell is occupied if p is above the upper threshold, free if it is below the lower threshold, and unknown
    /// between. Transparency counts as a fourth colour, as in ROS.
    #[default]
    Trinary,
    /// The same as `Trinary`, but pixels that are not opaque are unknown. (Between the thresholds, ROS computes a
    /// probability from 0 to 99 %; a wall of a world is either solid or absent.)
    Scale,
    /// The grey itself, from 0 to 100, is p in percent, and is not negated. Greater greys are unknown.
    Raw,
}

/// The description of a map, from its YAML file.
///
/// ```
/// use envgen::export::ros_map::RosCell;
/// use envgen::import::ros_map::{RosDescription, UnknownCells};
///
/// let description = RosDescription::from_yaml(
///     "image: map.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 0.0]\nnegate: 0\n\
///      occupied_thresh: 0.65\nfree_thresh: 0.196\n",
/// )?;
/// // A grey image of 2 x 1 pixels: black is occupied, white is free.
/// let map = description.map(b"P5\n2 1\n255\n\x00\xff")?;
/// assert_eq!(map.cells, [RosCell::Occupied, RosCell::Free]);
/// let world = map.to_world(UnknownCells::Solid);
/// assert_eq!(world.walls[0].shape.bounds().min, envgen::glam::DVec2::new(1.0, 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RosDescription {
    /// The image file. A relative name starts at the folder of the description.
    pub image: String,
    /// Side of a cell in metres.
    pub resolution: f64,
    /// Lower left corner of the map in metres, and direction of its rows in radians.
    pub origin: [f64; 3],
    /// Whether white is occupied and black is free.
    #[serde(deserialize_with = "flag")]
    pub negate: bool,
    /// Probability of occupancy above which a cell is occupied.
    pub occupied_thresh: f64,
    /// Probability of occupancy below which a cell is free.
    pub free_thresh: f64,
    /// The conversion of greys into occupancy, in upper or lower case.
    #[serde(default, deserialize_with = "mode")]
    pub mode: RosMode,
}

/// Reads a mode, whose capitals Nav2 ignores.
fn mode<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<RosMode, D::Error> {
    let word = String::deserialize(deserializer)?;
    let known = [("trinary", RosMode::Trinary), ("scale", RosMode::Scale), ("raw", RosMode::Raw)];
    let found = known.into_iter().find(|(name, _)| word.eq_ignore_ascii_case(name));
    found.map(|(_, mode)| mode).ok_or_else(|| {
        let text = format!("`{word}` is not one of trinary, scale, raw");
        serde::de::Error::custom(text)
    })
}

/// Reads a flag, which is 0 or 1 in files of ROS; `true` and `false` are read, too.
fn flag<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged, expecting = "`negate` must be 0, 1, false or true")]
    enum Flag {
        Word(bool),
        Number(i64),
    }
    match Flag::deserialize(deserializer)? {
        Flag::Word(flag) => Ok(flag),
        Flag::Number(number @ 0..=1) => Ok(number == 1),
        Flag::Number(other) => {
            let text = format!("`negate` must be 0, 1, false or true, got {other}");
            Err(serde::de::Error::custom(text))
        }
    }
}

impl RosDescription {
    /// Returns the path of the image for a description at the path `yaml`, relative to whose folder the image is named.
    pub fn image_path(&self, yaml: &Path) -> PathBuf {
        yaml.parent().unwrap_or(Path::new("")).join(&self.image)
    }

    /// Reads a description and checks it. Unknown fields are ignored.
    ///
    /// # Errors
    /// When the text is not YAML, when a field is missing, or when a value is not allowed.
    pub fn from_yaml(text: &str) -> Result<Self, RosMapError> {
        let description: RosDescription = serde_saphyr::from_str(text)
            .map_err(|error| RosMapError::Yaml(yaml::reason(&error, text)))?;
        description.check()?;
        Ok(description)
    }

    fn check(&self) -> Result<(), SpecError> {
        if self.image.is_empty() {
            return Err(SpecError::new("image", "\"\"", "the name of a PGM or PNG file"));
        }
        if !RESOLUTIONS.contains(&self.resolution) {
            let allowed = format!("from {} to {} m", RESOLUTIONS.start(), RESOLUTIONS.end());
            return Err(SpecError::new("resolution", self.resolution, allowed));
        }
        if !self.origin.iter().all(|value| value.abs() <= MAX_COORDINATE) {
            let value = format!("{:?}", self.origin);
            let allowed = format!("three numbers from -{MAX_COORDINATE} to {MAX_COORDINATE}");
            return Err(SpecError::new("origin", value, allowed));
        }
        let thresholds =
            [("occupied_thresh", self.occupied_thresh), ("free_thresh", self.free_thresh)];
        for (field, value) in thresholds {
            if !(0.0..=1.0).contains(&value) {
                return Err(SpecError::new(field, value, "from 0 to 1"));
            }
        }
        // In the maps of BARN they are equal.
        if self.free_thresh > self.occupied_thresh {
            let allowed = format!("at most `occupied_thresh`, {}", self.occupied_thresh);
            return Err(SpecError::new("free_thresh", self.free_thresh, allowed));
        }
        Ok(())
    }

    /// Makes a map from the bytes of its image, a PGM or a PNG.
    ///
    /// # Errors
    /// When the image is invalid, or when it has too many pixels.
    pub fn map(&self, image: &[u8]) -> Result<RosMap, ImageError> {
        let image = read_image(image, |shade| self.cell(&shade))?;
        let cells = image.pixels.chunks_exact(image.cols).rev().flatten().copied().collect();
        let [x, y, heading] = self.origin;
        let origin = Pose::new(x, y, heading);
        Ok(RosMap { cols: image.cols, resolution: self.resolution, origin, cells })
    }

    fn cell(&self, shade: &Shade) -> RosCell {
        let colour = match (self.mode, shade.alpha) {
            (RosMode::Trinary, Some(alpha)) => (3.0 * shade.colour + alpha) / 4.0,
            (RosMode::Scale, Some(alpha)) if alpha < 1.0 => return RosCell::Unknown,
            _ => shade.colour,
        };
        let p = match self.mode {
            RosMode::Raw => {
                let percent = (colour * 255.0).round();
                if percent > MAX_PERCENT {
                    return RosCell::Unknown;
                }
                percent / MAX_PERCENT
            }
            _ if self.negate => colour,
            _ => 1.0 - colour,
        };
        if p > self.occupied_thresh {
            RosCell::Occupied
        } else if p < self.free_thresh {
            RosCell::Free
        } else {
            RosCell::Unknown
        }
    }
}

/// What unknown cells become in a world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UnknownCells {
    /// Obstacles, because no free path through them is known. A map is thereby closed where its walls have holes.
    #[default]
    Solid,
    /// Free ground.
    Free,
}

/// A rectangle of cells: columns and rows, each from the first to the one after the last, counted from the map's
/// lower left corner.
type Cells = ([i64; 2], [i64; 2]);

impl RosMap {
    /// Returns the map as a world. Occupied cells become walls, whose outlines are exactly those of the cells: each
    /// wall is a box of a run of cells in a row, or of equal runs in consecutive rows. Unknown cells become
    /// obstacles of the kind [`ObstacleKind::Other`] in the same form, or free ground. The ground beyond the map is
    /// unknown, too: where the border of the map is open, obstacles one cell wide close it, within the world's
    /// bounds.
    ///
    /// The world's start is the point of greatest clearance in the largest free region, by [`max_clearance_point`],
    /// heading along the map's rows. Cells that are smaller than 1 cm are joined to cells of 10 cm for it. There is no
    /// start if no cell is free. Another start can be set in [`World::start`].
    pub fn to_world(&self, unknown: UnknownCells) -> World {
        let is_solid = |cell: &RosCell| match cell {
            RosCell::Occupied => true,
            RosCell::Unknown => unknown == UnknownCells::Solid,
            RosCell::Free => false,
        };
        let solid: Vec<bool> = self.cells.iter().map(is_solid).collect();
        let whole = ([0, self.cols as i64], [0, self.rows() as i64]);
        let border = self.border(&solid);
        let corners = border.iter().chain([&whole]).flat_map(|rect| self.box_of(*rect).corners());
        let bounds = Rect::around(corners).unwrap_or(Rect::new(DVec2::ZERO, DVec2::ONE));
        let heading = self.origin.heading;
        let source = serde_json::json!({
            "format": "ros_map",
            "cols": self.cols,
            "rows": self.rows(),
            "resolution": self.resolution,
            "origin": [self.origin.position.x, self.origin.position.y, heading],
        });
        let mut world = World::new(Provenance::other(IMPORT, source), bounds);
        let wall = |cells| Wall::new(WallKind::Wall, self.box_of(cells));
        world.walls = self.boxes(RosCell::Occupied).into_iter().map(wall).collect();
        let inside = match unknown {
            UnknownCells::Solid => self.boxes(RosCell::Unknown),
            UnknownCells::Free => Vec::new(),
        };
        let obstacle = |cells| Obstacle::new(ObstacleKind::Other, self.box_of(cells));
        world.obstacles = inside.into_iter().chain(border).map(obstacle).collect();
        world.start = self.roomiest(solid).map(|position| Pose { position, heading });
        world
    }

    /// Returns the point of greatest clearance in the largest free region. Distances of more than 255 cells are all the
    /// same, which is near where cells are small, so that these are joined to larger ones first.
    fn roomiest(&self, solid: Vec<bool>) -> Option<DVec2> {
        let clear = |cols: usize, resolution: f64, solid: Vec<bool>| {
            let grid = OccupancyGrid::from_cells(DVec2::ZERO, resolution, cols, solid).ok()?;
            max_clearance_point(&grid).map(|place| self.origin.to_world(place))
        };
        if self.resolution < FINE_CELLS {
            let joined = (COARSE_CELLS / self.resolution).ceil() as usize;
            let [cols, rows] = [self.cols, self.rows()].map(|side| side / joined);
            let cell = |at: usize| {
                let (col, row) = (at % cols * joined, at / cols * joined);
                let mut rows = (row..row + joined).map(|row| row * self.cols + col);
                rows.any(|first| solid[first..first + joined].contains(&true))
            };
            let coarse = (0..cols * rows).map(cell).collect();
            let place = clear(cols, self.resolution * joined as f64, coarse);
            if place.is_some() {
                return place;
            }
        }
        clear(self.cols, self.resolution, solid)
    }

    /// Returns the boxes of cells around the map that close its border where it is open.
    fn border(&self, solid: &[bool]) -> Vec<Cells> {
        let (cols, rows) = (self.cols, self.rows());
        let mut boxes = Vec::new();
        // Each side: the number of its cells, the index of each, and the box that closes a run of them.
        let below = |[from, to]: [i64; 2]| ([from, to], [-1, 0]);
        let above = |[from, to]: [i64; 2]| ([from, to], [rows as i64, rows as i64 + 1]);
        let left = |[from, to]: [i64; 2]| ([-1, 0], [from, to]);
        let right = |[from, to]: [i64; 2]| ([cols as i64, cols as i64 + 1], [from, to]);
        let mut close =
            |len: usize, cell: &dyn Fn(usize) -> usize, beside: &dyn Fn([i64; 2]) -> Cells| {
                let open: Vec<bool> = (0..len).map(|i| !solid[cell(i)]).collect();
                let mut from = 0;
                for run in open.chunk_by(|a, b| a == b) {
                    let to = from + run.len();
                    if run[0] {
                        // Past the corners, so that there is no gap between two sides.
                        let low = if from == 0 { -1 } else { from as i64 };
                        let high = if to == len { to as i64 + 1 } else { to as i64 };
                        boxes.push(beside([low, high]));
                    }
                    from = to;
                }
            };
        if rows > 0 {
            close(cols, &|i| i, &below);
            close(cols, &|i| (rows - 1) * cols + i, &above);
            close(rows, &|i| i * cols, &left);
            close(rows, &|i| i * cols + cols - 1, &right);
        }
        boxes
    }

    fn box_of(&self, (cols, rows): Cells) -> Shape {
        let low = DVec2::new(cols[0] as f64, rows[0] as f64) * self.resolution;
        let high = DVec2::new(cols[1] as f64, rows[1] as f64) * self.resolution;
        if self.origin.heading == 0.0 {
            // Neighbours share their sides to the last bit, or nearly so.
            let origin = self.origin.position;
            return Shape::from_rect(Rect::new(origin + low, origin + high));
        }
        Shape::Box {
            center: self.origin.to_world(0.5 * (low + high)),
            half_size: 0.5 * (high - low),
            heading: self.origin.heading,
        }
    }

    /// Checks that the world of a map has at most [`MAX_BOXES`] walls and obstacles.
    pub(super) fn check_boxes(&self) -> Result<(), RosMapError> {
        let mut found = 0;
        for wanted in [RosCell::Occupied, RosCell::Unknown] {
            let mut below: Vec<(usize, usize)> = Vec::new();
            for cells in self.cells.chunks_exact(self.cols.max(1)) {
                let runs: Vec<_> = runs_of(cells, wanted).collect();
                found += runs.iter().filter(|run| below.binary_search(run).is_err()).count();
                below = runs;
            }
        }
        if found > MAX_BOXES { Err(RosMapError::Boxes { found }) } else { Ok(()) }
    }

    /// Returns rectangles of cells of a state, without overlap. A run of a row that lies over a run of the same
    /// columns is merged with it.
    fn boxes(&self, wanted: RosCell) -> Vec<Cells> {
        let mut done = Vec::new();
        // Runs that end at the row below: their columns, and the row that they begin at.
        let mut open: Vec<((usize, usize), usize)> = Vec::new();
        let rows = self.cells.chunks_exact(self.cols.max(1));
        for (row, cells) in rows.enumerate() {
            let mut runs = Vec::new();
            let mut below = open.iter().copied().peekable();
            for run in runs_of(cells, wanted) {
                while let Some((other, from)) = below.next_if(|(other, _)| other.0 < run.0) {
                    done.push((other, (from, row)));
                }
                let same = below.next_if(|(other, _)| *other == run);
                runs.push((run, same.map_or(row, |(_, from)| from)));
            }
            done.extend(below.map(|(run, from)| (run, (from, row))));
            open = runs;
        }
        done.extend(open.into_iter().map(|(run, from)| (run, (from, self.rows()))));
        let range = |(from, to): (usize, usize)| [from as i64, to as i64];
        done.into_iter().map(|(cols, rows)| (range(cols), range(rows))).collect()
    }
}

/// Returns the runs of cells of a state in a row, each with its first column and the one after its last.
fn runs_of(cells: &[RosCell], wanted: RosCell) -> impl Iterator<Item = (usize, usize)> {
    let mut end = 0;
    cells.chunk_by(|a, b| a == b).filter_map(move |run| {
        let start = end;
        end += run.len();
        (run[0] == wanted).then_some((start, end))
    })
}

/// Returns the image that the description of a map names; `None` if the file is not a description.
pub(super) fn image_of(path: &Path) -> Option<PathBuf> {
    Some(description_at(path)?.image_path(path))
}

/// Returns the description of a map that a file holds; `None` if the file is not a description.
fn description_at(path: &Path) -> Option<RosDescription> {
    let is_yaml = |ending: &std::ffi::OsStr| {
        ending.eq_ignore_ascii_case("yaml") || ending.eq_ignore_ascii_case("yml")
    };
    if !path.extension().is_some_and(is_yaml) {
        return None;
    }
    // What can be read once only is left for the reader.
    if !path.metadata().is_ok_and(|data| data.is_file()) {
        return None;
    }
    let text = file::read_text(&mut File::open(path).ok()?).ok()?;
    RosDescription::from_yaml(&text).ok()
}

/// Returns a warning about a ROS map whose unknown cells seem to be free; `None` for other maps and other files.
///
/// Savers of Nav2 write the grey 205 for unknown cells, and by default the threshold 0.25 for free ones, which makes
/// unknown cells free. In trinary maps, an alpha channel makes them free under any usual threshold, because its opaque
/// white is averaged in.
pub fn unknown_cells_warning(path: &Path) -> Option<String> {
    let description = description_at(path)?;
    let bytes = file::read_bytes(&mut File::open(description.image_path(path)).ok()?).ok()?;
    let is_free = |shade: &Shade| description.cell(shade) == RosCell::Free;
    // Whether it is suspect, and whether alpha counts.
    let suspect = |shade: Shade| {
        let is_saved = (255.0 * shade.colour).round() == SAVED_UNKNOWN;
        let is_mixed = description.mode == RosMode::Trinary && shade.alpha.is_some();
        (is_saved && is_free(&shade)).then_some(is_mixed)
    };
    let pixels = read_image(&bytes, suspect).ok()?.pixels;
    let suspects = || pixels.iter().flatten();
    let share = suspects().count() as f64 / pixels.len() as f64;
    if share < SUSPECT_SHARE {
        return None;
    }
    let is_mixed = suspects().any(|is_mixed| *is_mixed);
    let is_low = !is_free(&Shade { colour: SAVED_UNKNOWN / 255.0, alpha: None });
    let free = format!("`free_thresh: {}` makes them free", description.free_thresh);
    let cause = match (is_low, is_mixed) {
        (true, _) => "the alpha channel makes them free, as trinary maps count it as a fourth colour: save the \
                      image without alpha"
            .to_owned(),
        (false, true) => format!("{free}: with 0.196, and an image without alpha, they are unknown"),
        (false, false) => format!("{free}: with 0.196 they are unknown"),
    };
    Some(format!(
        "{:.0} % of the pixels have the grey {SAVED_UNKNOWN}, which savers of maps write for unknown cells, but \
         {cause}",
        100.0 * share
    ))
}

/// Reads the YAML of a map, and the image that it names. `path` is the path of the YAML file.
///
/// # Errors
/// When the YAML or the image cannot be read, or when they do not contain a map.
pub fn read_ros_map(input: &mut dyn Read, path: &Path) -> Result<RosMap, RosMapError> {
    let description = RosDescription::from_yaml(&file::read_text(input)?)?;
    let path = description.image_path(path);
    let bytes = match File::open(&path).map_err(FileError::Io) {
        Ok(mut file) => file::read_bytes(&mut file),
        Err(error) => Err(error),
    };
    match bytes {
        Ok(bytes) => description.map(&bytes).map_err(|error| RosMapError::Image { path, error }),
        Err(error) => Err(RosMapError::Missing { path, error }),
    }
}

#[cfg(test)]
mod tests;
