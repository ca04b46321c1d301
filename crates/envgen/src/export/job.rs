//! Jobs: what to write, and the options of the formats.

use std::io::Write;
use std::path::Path;

use super::error::ExportError;
#[cfg(feature = "paths")]
use super::movingai;
use super::ros_map::{self, RosMap};
use crate::import::class_labels;
#[cfg(feature = "picture")]
use crate::picture::PictureOptions;
use crate::scenario::Scenario;
#[cfg(feature = "paths")]
use crate::seed::Seed;
use crate::spec::WorldBlueprint;
use crate::world::{ClassRaster, World};

/// Number of tasks in a MovingAI scenario file.
#[cfg(feature = "paths")]
const TASKS: usize = 100;

/// A world to write, and the options of the formats.
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
    /// The blueprint from which the world was built, for formats that contain plans. Worlds that were read from a
    /// file have no blueprint.
    pub blueprint: Option<&'a WorldBlueprint>,
    /// The file's name without its ending, for formats with several files that refer to each other.
    pub stem: String,
    /// The name of the format's first file, to which its other files refer; `None` if it is the stem with the format's
    /// ending.
    pub name: Option<String>,
    /// Side in metres of the cells of maps whose cell size can be chosen; `None` for the default
    /// ([`ros_map::usual_resolution`]).
    pub resolution: Option<f64>,
    /// The moving elements of the world. Pictures show them only if their options contain the scenario as well.
    pub scenario: Option<&'a Scenario>,
    /// The options of pictures.
    #[cfg(feature = "picture")]
    pub picture: PictureOptions,
}

impl<'a> Job<'a> {
    /// Creates a job for a world, with every option at its default and the stem `world`.
    pub fn new(world: &'a World) -> Self {
        Job {
            world,
            blueprint: None,
            stem: "world".to_owned(),
            name: None,
            resolution: None,
            scenario: None,
            #[cfg(feature = "picture")]
            picture: PictureOptions::default(),
        }
    }

    /// Creates a job for a world and a file of this name.
    pub fn for_path(world: &'a World, path: &Path) -> Self {
        let mut job = Job::new(world);
        if let Some(stem) = path.file_stem() {
            job.stem = stem.to_string_lossy().into_owned();
        }
        job.name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        job
    }

    pub(super) fn raster(&self) -> Result<&'a ClassRaster, ExportError> {
        self.world.raster.as_ref().ok_or(ExportError::Empty { part: "raster of classes" })
    }

    /// Returns the values that the classes of a raster had in the file from which it was read, if these are not
    /// class numbers: one value for each class, all different.
    pub(super) fn class_labels(&self) -> Option<Vec<i64>> {
        class_labels(&self.world.provenance.spec, self.world.raster.as_ref()?)
    }

    pub(super) fn write_scenario(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let scenario =
            self.scenario.ok_or(ExportError::Empty { part: "doors, people or smoke that move" })?;
        Ok(out.write_all(scenario.to_ron()?.as_bytes())?)
    }

    fn ros_resolution(&self) -> f64 {
        self.resolution.unwrap_or_else(|| ros_map::usual_resolution(self.world))
    }

    pub(super) fn write_ros_description(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let (resolution, image) = (self.ros_resolution(), format!("{}.pgm", self.stem));
        ros_map::size_in_cells(self.world, resolution)?;
        Ok(ros_map::write_description(&image, resolution, ros_map::origin(self.world), out)?)
    }

    pub(super) fn write_ros_image(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(RosMap::of_world(self.world, self.ros_resolution())?.write_pgm(out)?)
    }

    #[cfg(feature = "paths")]
    pub(super) fn write_scenarios(&self, out: &mut dyn Write) -> Result<(), ExportError> {
        let seed = self.world.provenance.seed.unwrap_or(Seed(0));
        let map = self.name.clone().unwrap_or_else(|| format!("{}.map", self.stem));
        let tasks = movingai::scenarios(self.raster()?, &map, TASKS, seed)?;
        Ok(movingai::write_scenarios(&tasks, out)?)
    }
}
