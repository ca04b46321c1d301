//! Reading worlds, in the format that the ending of the file's name selects.

mod asc;
#[cfg(feature = "barn")]
pub mod barn;
#[cfg(feature = "picture")]
mod class_png;
#[cfg(feature = "geojson")]
mod geojson;
#[cfg(feature = "ros")]
mod grey_image;
mod houseexpo;
mod made_by;
#[cfg(feature = "paths")]
mod movingai;
mod plan_error;
mod raster;
#[cfg(feature = "ros")]
pub mod ros_map;
mod start;

use std::fs::File;
use std::io::Read;
use std::iter;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::provenance::IMPORT;
pub use asc::read_asc;
#[cfg(feature = "picture")]
pub use class_png::read_class_png;
#[cfg(feature = "geojson")]
pub use geojson::read_geojson;
pub use houseexpo::read_houseexpo;
#[cfg(feature = "paths")]
pub use movingai::{read_map, read_scenarios};
pub use plan_error::PlanError;
pub(crate) use raster::class_labels;
pub use raster::{ImportedRaster, RasterFileError, read_raster_json};
#[cfg(feature = "ros")]
use ros_map::{RosMapError, UnknownCells};

use crate::file::{self, FileError};
#[cfg(feature = "usarsim")]
use crate::generate::Blueprint;
#[cfg(feature = "usarsim")]
use crate::indoor::Catalogue;
#[cfg(feature = "usarsim")]
use crate::indoor::world_generator::{
    LibraryRoom, Project, WorldGeneratorError, read_library, read_project,
};
use crate::landscape::raster_world;
use crate::provenance::Provenance;
use crate::world::World;

/// The reasons why a world could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The ending of the file's name does not belong to any format.
    #[error("unknown file ending in `{path}`, expected one of {known}")]
    UnknownEnding {
        /// The file's name.
        path: PathBuf,
        /// The endings that exist.
        known: String,
    },
    /// The file does not contain a world.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file does not contain a raster.
    #[error(transparent)]
    Raster(#[from] RasterFileError),
    /// The file does not contain a map for robots.
    #[cfg(feature = "ros")]
    #[error(transparent)]
    RosMap(#[from] RosMapError),
    /// The file is not a project of the World Generator.
    #[cfg(feature = "usarsim")]
    #[error(transparent)]
    WorldGenerator(#[from] WorldGeneratorError),
    /// The file does not contain shapes of its format.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// A function that reads a world and checks it. The path is that of the input, for formats whose files refer to
/// other files.
pub type Reader = fn(&mut dyn Read, &Path) -> Result<World, ImportError>;

/// The formats, each with the ending of the file's name and the reader.
pub const READERS: &[(&str, Reader)] = &[
    ("json", |input, _| read_json_or_house(input)),
    ("ron", |input, _| read_ron(input)),
    #[cfg(feature = "geojson")]
    ("geojson", |input, _| Ok(read_geojson(input)?)),
    ("asc", |input, _| world_of_raster("esri_ascii_grid", read_asc(input)?)),
    #[cfg(feature = "paths")]
    ("map", |input, _| world_of_raster("movingai_map", read_map(input)?)),
    #[cfg(feature = "barn")]
    ("npy", |input, path| Ok(barn::read_grid_world(input, path)?)),
    #[cfg(feature = "barn")]
    ("world", |input, _| Ok(barn::read_gazebo_world(input)?)),
    #[cfg(feature = "usarsim")]
    ("xml", |input, _| read_world_generator(input)),
    #[cfg(feature = "ros")]
    ("yaml", world_of_ros_map),
    #[cfg(feature = "ros")]
    ("yml", world_of_ros_map),
];

/// Returns the reader of a file, selected by the ending of its name in upper or lower case.
///
/// ```
/// use std::path::Path;
///
/// use envgen::import::reader;
/// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
///
/// let world = HallwaySpec::default().generate(Seed(7))?.to_world();
/// let path = Path::new("hallway.RON");
/// let read = reader(path)?(&mut world.to_ron()?.as_bytes(), path)?;
/// assert_eq!(read, world);
/// let error = reader(Path::new("hallway.doc")).err().expect("no such format");
/// assert!(error.to_string().contains(".json, .ron"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error that lists the endings that exist.
pub fn reader(path: &Path) -> Result<Reader, ImportError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let found = READERS.iter().find(|(known, _)| Some(*known) == ending.as_deref());
    found.map(|&(_, reader)| reader).ok_or_else(|| {
        let known: Vec<_> = READERS.iter().map(|(ending, _)| format!(".{ending}")).collect();
        ImportError::UnknownEnding { path: path.to_owned(), known: known.join(", ") }
    })
}

/// Reads a world from a file, in the format that the ending of its name selects.
///
/// # Errors
/// When the ending is unknown, when the file cannot be read, or when it does not contain a world.
pub fn read_world(path: &Path) -> Result<World, ImportError> {
    let reader = reader(path)?;
    let mut file = File::open(path).map_err(FileError::Io)?;
    reader(&mut file, path)
}

/// Returns the files from which a world is read, which outputs must not replace: the file itself, and the image
/// that the description of a ROS map names.
pub fn input_files(path: &Path) -> Vec<PathBuf> {
    #[cfg(feature = "ros")]
    let image = ros_map::image_of(path);
    #[cfg(not(feature = "ros"))]
    let image = None;
    iter::once(path.to_owned()).chain(image).collect()
}

/// Reads a world from its JSON file.
///
/// # Errors
/// When the file does not contain a world of this crate's schema, or when the world is invalid.
pub fn read_json(input: &mut dyn Read) -> Result<World, ImportError> {
    Ok(World::from_json(&file::read_text(input)?)?)
}

/// Reads a world from its JSON file, or a house of HouseExpo. The names of both files end with `.json`.
fn read_json_or_house(input: &mut dyn Read) -> Result<World, ImportError> {
    let text = file::read_text(input)?;
    if houseexpo::is_house(&text) {
        return Ok(read_houseexpo(&mut text.as_bytes())?);
    }
    Ok(World::from_json(&text)?)
}

/// Reads a world from its RON file.
///
/// # Errors
/// When the file does not contain a world of this crate's schema, or when the world is invalid.
pub fn read_ron(input: &mut dyn Read) -> Result<World, ImportError> {
    Ok(World::from_ron(&file::read_text(input)?)?)
}

/// Reads a project of the World Generator for `USARSim`, with the built-in rooms. See
/// [`read_world_generator_project`] for other rooms.
///
/// # Errors
/// When the file is not a project, or when a room is unknown, overlaps another room or extends beyond the world.
#[cfg(feature = "usarsim")]
pub fn read_world_generator(input: &mut dyn Read) -> Result<World, ImportError> {
    Ok(read_world_generator_project(input, Catalogue::builtin(), &[])?.plan.to_world())
}

/// Reads a project of the World Generator for `USARSim`, with the rooms of a catalogue and, for other rooms, bare
/// rooms of libraries.
///
/// # Errors
/// When the file is not a project, or when a room is unknown, overlaps another room or extends beyond the world.
#[cfg(feature = "usarsim")]
pub fn read_world_generator_project(
    input: &mut dyn Read,
    catalogue: &Catalogue,
    library: &[LibraryRoom],
) -> Result<Project, ImportError> {
    Ok(read_project(&file::read_text(input)?, catalogue, library)?)
}

/// Reads a library of rooms of the World Generator.
///
/// # Errors
/// When the file is not a library.
#[cfg(feature = "usarsim")]
pub fn read_world_generator_library(input: &mut dyn Read) -> Result<Vec<LibraryRoom>, ImportError> {
    Ok(read_library(&file::read_text(input)?)?)
}

/// Reads a ROS map, in which unknown cells count as solid.
#[cfg(feature = "ros")]
fn world_of_ros_map(input: &mut dyn Read, path: &Path) -> Result<World, ImportError> {
    let map = ros_map::read_ros_map(input, path)?;
    map.check_boxes()?;
    let world = map.to_world(UnknownCells::default());
    world.check().map_err(FileError::World)?;
    Ok(world)
}

impl ImportedRaster {
    /// Reads a raster in the format that the ending of a file's name selects.
    ///
    /// # Errors
    /// When the ending is unknown (the error lists the known ones), or when the file does not contain a raster of
    /// that format.
    pub fn read(name: &Path, input: &mut dyn Read) -> Result<Self, RasterFileError> {
        let ending = name.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("asc") => read_asc(input),
            Some("json") => read_raster_json(input),
            #[cfg(feature = "paths")]
            Some("map") => read_map(input),
            #[cfg(feature = "picture")]
            Some("png") => read_class_png(input),
            _ => Err(RasterFileError::UnknownEnding(name.display().to_string())),
        }
    }
}

/// Builds the world of a raster that was read. All ground can be passed if the format has no speeds.
fn world_of_raster(format: &str, read: ImportedRaster) -> Result<World, ImportError> {
    let source = serde_json::json!({ "format": format, "labels": read.labels });
    let world = raster_world(read.raster, Provenance::other(IMPORT, source));
    world.check().map_err(FileError::World)?;
    Ok(world)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "paths")]
    #[test]
    fn a_map_becomes_a_world_with_obstacles() {
        let map = "type octile\nheight 3\nwidth 5\nmap\n.....\n.@@S.\n.@..T\n";
        let world =
            reader(Path::new("a.map")).unwrap()(&mut map.as_bytes(), Path::new("a.map")).unwrap();
        let area: f64 = world.obstacles.iter().map(|obstacle| obstacle.shape.area()).sum();
        assert_eq!(area, 4.0);
        assert_eq!(world.surfaces.len(), 1);
        assert!(world.start.is_some());
        let grid = "ncols 2\nnrows 1\nxllcorner 5\nyllcorner 6\ncellsize 2\n3 4\n";
        let world =
            reader(Path::new("a.asc")).unwrap()(&mut grid.as_bytes(), Path::new("a.asc")).unwrap();
        assert_eq!(world.bounds.max, glam::DVec2::new(9.0, 8.0));
    }

    #[test]
    fn endings_find_their_reader() {
        assert!(reader(Path::new("a.JSON")).is_ok() && reader(Path::new("a.b.ron")).is_ok());
        for name in ["world", "world.png", ".ron"] {
            let error = reader(Path::new(name)).unwrap_err().to_string();
            assert!(
                error.contains(&format!("`{name}`")) && error.contains(".json, .ron"),
                "{error}"
            );
        }
    }
}
