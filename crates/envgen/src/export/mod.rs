//! Writing worlds: every format that a world can be written in, by the ending of the file's name.
//!
//! A [`Format`] is one line of the table below: what it is, and for each of its files the ending
//! and the function that writes it. Most formats are one file; a format with several, such as an
//! image with its description, lists the file that refers to the others first.
//!
//! ```
//! use envgen::export::{Format, Job};
//! use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
//!
//! let world = HallwaySpec::default().generate(Seed(7))?.to_world();
//! let format = Format::from_path("hallway.json".as_ref())?;
//! let mut file = Vec::new();
//! format.write(&Job::new(&world), &mut file)?;
//! assert_eq!(envgen::import::read_json(&mut file.as_slice())?, world);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod asc;
#[cfg(any(feature = "mjcf", feature = "sdf", feature = "usd"))]
mod body;
#[cfg(feature = "rmf")]
mod building;
#[cfg(feature = "picture")]
pub mod class_png;
#[cfg(feature = "csv")]
mod csv;
#[cfg(feature = "geojson")]
mod geojson;
#[cfg(feature = "gltf")]
mod gltf;
mod houseexpo;
#[cfg(feature = "mjcf")]
mod mjcf;
#[cfg(feature = "paths")]
pub mod movingai;
#[cfg(feature = "csv")]
mod obstacles_csv;
#[cfg(feature = "opendrive")]
mod opendrive;
#[cfg(feature = "whole-file")]
mod output;
#[cfg(any(feature = "gltf", feature = "mjcf", feature = "sdf", feature = "usd"))]
mod places;
#[cfg(feature = "opendrive")]
mod road_objects;
pub mod ros_map;
#[cfg(feature = "sdf")]
mod sdf;
#[cfg(feature = "usd")]
mod usd;
#[cfg(any(feature = "mjcf", feature = "opendrive", feature = "sdf"))]
mod xml;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub use asc::write_asc;
#[cfg(feature = "whole-file")]
pub use output::{Output, OutputError, write_whole};
use thiserror::Error;

use self::ros_map::RosMap;
use crate::file::FileError;
use crate::landscape::metrics::RasterError;
use crate::occupancy::OccupancyError;
#[cfg(feature = "picture")]
use crate::picture::{PictureError, PictureOptions};
use crate::scenario::{Scenario, ScenarioFileError};
#[cfg(feature = "paths")]
use crate::seed::Seed;
use crate::spec::WorldBlueprint;
use crate::world::{ClassRaster, World};

/// Number of tasks in a MovingAI scenario file.
#[cfg(feature = "paths")]
const TASKS: usize = 100;

/// Why a world could not be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The file's name has the ending of no format.
    #[error("unknown file ending in `{path}`, expected one of {known}")]
    UnknownEnding {
        /// The file's name.
        path: PathBuf,
        /// The endings that exist.
        known: String,
    },
    /// The format is in another build of the crate.
    #[error(
        "`{path}` needs the feature `{feature}`, which this build of envgen does not have: \
         `cargo install --path crates/envgen --features cli,{feature}`"
    )]
    Feature {
        /// The file's name.
        path: PathBuf,
        /// The feature of the crate.
        feature: &'static str,
    },
    /// Writing failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The format holds blueprints of another kind than this world's.
    #[error("{format} holds {wanted}, but this world was not built from one")]
    Blueprint {
        /// The format.
        format: &'static str,
        /// What it holds.
        wanted: &'static str,
    },
    /// The world cannot be written to a world file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The world's raster is invalid.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// The world has no part that the format can hold.
    #[error("the world has no {part}, and files of this format hold nothing else")]
    Empty {
        /// The part that the format holds.
        part: &'static str,
    },
    /// The scenario cannot be written.
    #[error(transparent)]
    Scenario(#[from] ScenarioFileError),
    /// A part of the world has no mesh.
    #[cfg(feature = "mesh")]
    #[error(transparent)]
    Mesh(#[from] crate::mesh::MeshError),
    /// The world is larger than files of the format can be.
    #[error("the world takes more than the {limit} that a file of {format} can hold")]
    TooLarge {
        /// The format.
        format: &'static str,
        /// The most that it holds.
        limit: &'static str,
    },
    /// No grid of the world could be made.
    #[error(transparent)]
    Occupancy(#[from] OccupancyError),
    /// The world cannot be drawn.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// What to write, and how.
///
/// ```
/// use envgen::export::{Format, Job};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// // A map for ROS with cells of 10 cm, whose description names its image `forest.pgm`.
/// let job = Job { stem: "forest".to_owned(), resolution: Some(0.1), ..Job::new(&world) };
/// let mut description = Vec::new();
/// Format::from_path("forest.yaml".as_ref())?.write(&job, &mut description)?;
/// assert!(String::from_utf8(description)?.contains("forest.pgm"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// The world.
    pub world: &'a World,
    /// The blueprint that the world was built from, for formats that hold plans. Worlds that were
    /// read from a file have none.
    pub blueprint: Option<&'a WorldBlueprint>,
    /// The file's name without its ending, for formats of several files that name each other.
    pub stem: String,
    /// Side in metres of the cells of maps whose cell size can be chosen; `None` for the usual one
    /// ([`ros_map::usual_resolution`]).
    pub resolution: Option<f64>,
    /// What moves in the world. Pictures show it if their options hold it too.
    pub scenario: Option<&'a Scenario>,
    /// How pictures are drawn.
    #[cfg(feature = "picture")]
    pub picture: PictureOptions,
}

impl<'a> Job<'a> {
    /// A world to write, with every option at its default and the stem `world`.
    pub fn new(world: &'a World) -> Self {
        Job {
            world,
            blueprint: None,
            stem: "world".to_owned(),
            resolution: None,
            scenario: None,
            #[cfg(feature = "picture")]
            picture: PictureOptions::default(),
        }
    }

    /// The job for a file of this name.
    pub fn for_path(world: &'a World, path: &Path) -> Self {
        let mut job = Job::new(world);
        if let Some(stem) = path.file_stem() {
            job.stem = stem.to_string_lossy().into_owned();
        }
        job
    }

    fn raster(&self) -> Result<&'a ClassRaster, ExportError> {
        self.world.raster.as_ref().ok_or(ExportError::Empty { part: "raster of classes" })
    }

    fn write_scenario(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let scenario =
            self.scenario.ok_or(ExportError::Empty { part: "doors, people or smoke that move" })?;
        Ok(out.write_all(scenario.to_ron()?.as_bytes())?)
    }

    fn ros_resolution(&self) -> f64 {
        self.resolution.unwrap_or_else(|| ros_map::usual_resolution(self.world))
    }

    fn write_ros_description(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let (resolution, image) = (self.ros_resolution(), format!("{}.pgm", self.stem));
        ros_map::size_in_cells(self.world, resolution)?;
        Ok(ros_map::write_description(&image, resolution, ros_map::origin(self.world), out)?)
    }

    fn write_ros_image(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(RosMap::of_world(self.world, self.ros_resolution())?.write_pgm(out)?)
    }

    #[cfg(feature = "paths")]
    fn write_scenarios(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let seed = self.world.provenance.seed.unwrap_or(Seed(0));
        let map = format!("{}.map", self.stem);
        let tasks = movingai::scenarios(self.raster()?, &map, TASKS, seed)?;
        Ok(movingai::write_scenarios(&tasks, out)?)
    }
}

/// Writes one file of a format.
pub type Writer = fn(&Job<'_>, &mut dyn Write) -> Result<(), ExportError>;

/// One line per format: feature that it needs, variant, what it is, and its files, each an ending and a writer.
macro_rules! formats {
    ($($(#[cfg(feature = $feature:literal)])? $variant:ident, $doc:literal,
        [$($ending:literal => $writer:expr),+];)+) => {
        /// A file format that worlds can be written in.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Format {
            $($(#[cfg(feature = $feature)])? #[doc = $doc] $variant,)+
        }

        /// The endings of each format and the feature that it needs, also of those that this build does not have.
        const NEEDED: &[(&[&str], &[&str])] = &[$((&[$($ending),+], &[$($feature)?])),+];

        impl Format {
            /// Every format of this build.
            pub const ALL: &'static [Format] = &[$($(#[cfg(feature = $feature)])? Format::$variant),+];

            /// What the format is, in one sentence.
            pub fn summary(self) -> &'static str {
                match self {
                    $($(#[cfg(feature = $feature)])? Format::$variant => $doc.trim_ascii(),)+
                }
            }

            /// The format's files: the ending of each and its writer. The first is the one that
            /// [`Format::from_path`] knows the format by.
            pub fn files(self) -> &'static [(&'static str, Writer)] {
                match self {
                    $($(#[cfg(feature = $feature)])? Format::$variant => &[$(($ending, $writer as Writer)),+],)+
                }
            }
        }
    };
}

formats! {
    Json, " The whole world as JSON, for reading back.",
        ["json" => |job, out| Ok(job.world.write_json(out)?)];
    Ron, " The whole world as RON, one line per part, for reading back.",
        ["ron" => |job, out| Ok(job.world.write_ron(out)?)];
    Scenario, " What moves in the world as RON: doors, people and smoke.",
        ["scenario.ron" => |job, out| job.write_scenario(out)];
    #[cfg(feature = "opendrive")]
    OpenDrive, " The roads, and what is solid, as OpenDRIVE 1.7.",
        ["xodr" => |job, out| opendrive::write(job.world, out)];
    #[cfg(feature = "csv")]
    Csv, " The waypoints of the roads as comma-separated values.",
        ["csv" => |job, out| csv::write(job.world, out)];
    #[cfg(feature = "csv")]
    ObstaclesCsv, " What is solid, start and goal as comma-separated values.",
        ["obstacles.csv" => |job, out| obstacles_csv::write(job.world, out)];
    #[cfg(feature = "geojson")]
    GeoJson, " All parts, start and goal as GeoJSON, in metres.",
        ["geojson" => |job, out| geojson::write(job.world, out)];
    HouseExpo, " The outline of the free ground and the rooms as in the data set HouseExpo.",
        ["house.json" => |job, out| houseexpo::write(job.world, &job.stem, job.resolution, out)];
    #[cfg(feature = "rmf")]
    Building, " Walls, doors and lanes as a building of Open-RMF.",
        ["building.yaml" => |job, out| building::write(job.world, out)];
    #[cfg(feature = "usarsim")]
    WorldGenerator, " An indoor plan as a project of the World Generator for USARSim.",
        ["xml" => write_world_generator];
    #[cfg(feature = "sdf")]
    Sdf, " The world in three dimensions for Gazebo, as SDFormat 1.9.",
        ["sdf" => |job, out| sdf::write(job.world, out)];
    #[cfg(feature = "mjcf")]
    Mjcf, " The world in three dimensions for MuJoCo.",
        ["mjcf.xml" => |job, out| mjcf::write(job.world, out)];
    #[cfg(feature = "gltf")]
    Gltf, " The world in three dimensions as meshes in glTF 2.0, in one binary file.",
        ["glb" => |job, out| gltf::write(job.world, out)];
    #[cfg(feature = "usd")]
    Usd, " The world in three dimensions as Universal Scene Description, in text.",
        ["usda" => |job, out| usd::write(job.world, out)];
    #[cfg(feature = "picture")]
    Svg, " A vector picture.",
        ["svg" => |job, out| Ok(crate::picture::write_svg(job.world, &job.picture, out)?)];
    #[cfg(feature = "picture")]
    Png, " A picture in pixels.",
        ["png" => |job, out| Ok(crate::picture::write_png(job.world, &job.picture, out)?)];
    Asc, " A landscape's classes as an ESRI ASCII grid.",
        ["asc" => |job, out| Ok(write_asc(job.raster()?, out)?)];
    #[cfg(feature = "picture")]
    ClassPng, " A landscape's classes as an image, one pixel per cell.",
        ["classes.png" => |job, out| Ok(class_png::write_class_png(job.raster()?, out)?)];
    #[cfg(feature = "paths")]
    MovingAi, " Where a landscape can be passed as a MovingAI map, with a scenario of 100 tasks.",
        ["map" => |job, out| Ok(movingai::write_map(job.raster()?, out)?),
         "scen" => |job, out| job.write_scenarios(out)];
    RosMap, " What is solid as a map for ROS and Nav2, a description and an image.",
        ["yaml" => |job, out| job.write_ros_description(out),
         "pgm" => |job, out| job.write_ros_image(out)];
}

#[cfg(feature = "usarsim")]
fn write_world_generator(job: &Job<'_>, mut out: &mut dyn Write) -> Result<(), ExportError> {
    match job.blueprint {
        Some(WorldBlueprint::Indoor(plan)) => {
            Ok(crate::indoor::world_generator::write_project(plan, &job.stem, &mut out)?)
        }
        _ => Err(ExportError::Blueprint {
            format: "a World Generator project",
            wanted: "the plan of an indoor map",
        }),
    }
}

impl Format {
    /// The ending of the format's first file, without the dot.
    pub fn ending(self) -> &'static str {
        self.files()[0].0
    }

    /// The format selected by the ending of a file's name, in upper or lower case.
    ///
    /// ```
    /// use envgen::export::Format;
    ///
    /// let format = Format::from_path("maps/Office.JSON".as_ref())?;
    /// assert_eq!(format.ending(), "json");
    /// // Of two endings that match, the longer one is meant.
    /// let scenario = Format::from_path("office.scenario.ron".as_ref())?;
    /// assert_eq!(scenario.ending(), "scenario.ron");
    /// assert!(Format::from_path("office.doc".as_ref()).is_err());
    /// # Ok::<(), envgen::export::ExportError>(())
    /// ```
    ///
    /// # Errors
    /// Lists the endings that exist, or names the feature of the crate that the format needs.
    pub fn from_path(path: &Path) -> Result<Format, ExportError> {
        let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase());
        let ends = |ending: &str| {
            let stem = name.as_ref()?.strip_suffix(ending)?.strip_suffix('.')?;
            (!stem.is_empty()).then_some(())
        };
        // Of two endings that match, such as `classes.png` and `png`, the longer one is meant.
        let fitting = NEEDED.iter().map(|(endings, features)| (endings[0], features));
        let meant = fitting.filter(|(ending, _)| ends(ending).is_some());
        let Some((ending, features)) = meant.max_by_key(|(ending, _)| ending.len()) else {
            let known: Vec<_> = Format::ALL.iter().map(|format| format!(".{format}")).collect();
            let known = known.join(", ");
            return Err(ExportError::UnknownEnding { path: path.to_owned(), known });
        };
        let format = Format::ALL.iter().copied().find(|format| format.ending() == ending);
        format.ok_or_else(|| ExportError::Feature {
            path: path.to_owned(),
            feature: features.first().copied().unwrap_or_default(),
        })
    }

    /// Writes the format's first file; for most formats it is the only one.
    ///
    /// # Errors
    /// When the format cannot hold the world, or writing fails.
    pub fn write(self, job: &Job<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        (self.files()[0].1)(job, out)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.ending())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn endings_find_their_format() {
        let mut endings = BTreeSet::new();
        for &format in Format::ALL {
            assert!(endings.insert(format.ending()), "{format} is listed twice");
            for name in [format!("a.b.{format}"), format!("A.{format}").to_uppercase()] {
                assert_eq!(Format::from_path(Path::new(&name)).unwrap(), format);
            }
        }
    }

    #[test]
    fn formats_of_other_builds_name_their_feature() {
        for (endings, features) in NEEDED {
            let name = format!("a.{}", endings[0]);
            match Format::from_path(Path::new(&name)) {
                Ok(format) => assert_eq!(format.ending(), endings[0]),
                Err(error) => {
                    let (error, feature) = (error.to_string(), features[0]);
                    let expected = format!("`{name}` needs the feature `{feature}`");
                    assert!(error.starts_with(&expected), "{error}");
                    assert!(error.contains(&format!("--features cli,{feature}`")), "{error}");
                }
            }
        }
        let has_usd = Format::from_path(Path::new("a.usda")).is_ok();
        assert_eq!(has_usd, cfg!(feature = "usd"));
    }

    #[test]
    fn unknown_endings_list_what_exists() {
        for name in ["world", "world.xyz", ".json", ""] {
            let error = Format::from_path(Path::new(name)).unwrap_err().to_string();
            assert!(
                error.contains(&format!("`{name}`")) && error.contains(".json, .ron"),
                "{error}"
            );
        }
    }
}
