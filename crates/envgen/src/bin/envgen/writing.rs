//! The files that a command writes a world to.

use std::path::{Path, PathBuf};

use clap::Args;
use envgen::export::ros_map::{self, RESOLUTIONS, size_in_cells, usual_resolution};
use envgen::export::{ExportError, Format, Job, Output, OutputError};
use envgen::located::Locate;
use envgen::picture::{PictureError, PictureOptions};
use envgen::scenario::Scenario;
use envgen::settings::Setting;
use envgen::whole_file::{WholeFile, commit_all};
use envgen::{World, WorldBlueprint};

use crate::failure::Failure;
use crate::progress::Steps;
use crate::source::note;

#[derive(Args)]
pub(crate) struct Writing {
    /// A file to write; may be given several times. The ending of its name selects the format, such as .json, .svg
    /// or .yaml (ROS map); an unknown ending lists all.
    #[arg(long, required = true, value_name = "FILE")]
    out: Vec<PathBuf>,

    /// Cell size of ROS maps (.yaml) and of outlines (.house.json) in metres, from 0.001 to 100000. A grid has at most
    /// 67,108,864 cells [default: 0.05, or more where a map would have more than 16,777,216 cells].
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    resolution: Option<f64>,

    #[command(flatten)]
    picture: PictureFile,
}

/// Files that were begun; they appear when they are committed.
pub(crate) struct Begun {
    outputs: Vec<Output>,
    files: Vec<WholeFile>,
    picture: PictureOptions,
    resolution: Option<f64>,
    /// What moves in the world.
    pub(crate) scenario: Option<Scenario>,
}

impl Writing {
    /// Begins the files, after all options were checked; none of them may be an input.
    pub(crate) fn begin(&self, inputs: &[PathBuf]) -> Result<Begun, Failure> {
        self.begin_in(inputs, |_| true)
    }

    /// The same for a world of a file, which has no plan: an unknown ending lists only the formats that do without.
    pub(crate) fn begin_without_plan(&self, inputs: &[PathBuf]) -> Result<Begun, Failure> {
        self.begin_in(inputs, Format::needs_only_a_world)
    }

    fn begin_in(
        &self,
        inputs: &[PathBuf],
        is_possible: fn(Format) -> bool,
    ) -> Result<Begun, Failure> {
        let picture = self.picture.options()?;
        let outputs = Output::all(&self.out, inputs).map_err(|mut located| {
            if let OutputError::Format(ExportError::UnknownEnding { known, .. }) =
                &mut located.error
            {
                *known = Format::endings(is_possible);
            }
            located
        })?;
        let resolution = self.resolution;
        check_resolution(resolution, &outputs)?;
        self.picture.check_use(&outputs)?;
        let mut files = Vec::new();
        for output in &outputs {
            files.push(output.create()?);
        }
        Ok(Begun { outputs, files, picture, resolution, scenario: None })
    }
}

impl Begun {
    /// How many steps it takes to write them.
    pub(crate) fn count(&self) -> usize {
        self.outputs.len()
    }

    /// Writes a world to all of them, a step for each.
    pub(crate) fn write(
        mut self,
        world: &World,
        blueprint: Option<&WorldBlueprint>,
        steps: &Steps,
    ) -> Result<(), Failure> {
        if self.picture.curvature_profile && world.road_strips.is_empty() {
            let text = "applies to roads, but the world has none".to_owned();
            return Err(Failure::Usage(text).about("--curvature-profile"));
        }
        say_sizes(world, self.resolution, &self.outputs)?;
        if self.scenario.is_some() && !self.outputs.iter().any(shows_scenario) {
            note(
                "the files do not hold the doors, people and smoke: pictures show them, and files that end with \
                 .scenario.ron hold them",
            );
        }
        self.picture.scenario.clone_from(&self.scenario);
        for (output, file) in self.outputs.iter().zip(&mut self.files) {
            steps.begin(format!("writing {}", output.asked.display()));
            let job = Job {
                blueprint,
                resolution: self.resolution,
                scenario: self.scenario.as_ref(),
                picture: self.picture.clone(),
                ..Job::for_path(world, &output.asked)
            };
            output.write(&job, file)?;
        }
        commit_all(self.files).map_err(|error| Failure::from(error).about("--out"))
    }
}

/// How pictures are drawn.
#[derive(Args)]
#[command(next_help_heading = "Pictures")]
struct PictureFile {
    /// Maximum width of pictures in pixels [default: 1000].
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    picture_width: Option<u32>,

    /// Maximum height of the plan in pictures in pixels [default: 800].
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    picture_height: Option<u32>,

    /// Title of pictures [default: kind and seed].
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,

    /// Draws a grid with a round number of metres per cell below the world.
    #[arg(long)]
    grid: bool,

    /// Draws the curvature of roads over their length, below the plan.
    #[arg(long)]
    curvature_profile: bool,
}

impl PictureFile {
    /// Checks that what is asked of pictures is asked for one.
    fn check_use(&self, outputs: &[Output]) -> Result<(), Failure> {
        let is_picture = |output: &Output| matches!(output.format, Format::Svg | Format::Png);
        if outputs.iter().any(is_picture) {
            return Ok(());
        }
        let asked = [
            ("--picture-width", self.picture_width.is_some()),
            ("--picture-height", self.picture_height.is_some()),
            ("--title", self.title.is_some()),
            ("--grid", self.grid),
            ("--curvature-profile", self.curvature_profile),
        ];
        match asked.into_iter().find(|(_, is_asked)| *is_asked) {
            Some((option, _)) => {
                let text = "applies to pictures, but no --out ends with .svg or .png".to_owned();
                Err(Failure::Usage(text).about(option))
            }
            None => Ok(()),
        }
    }

    fn options(&self) -> Result<PictureOptions, Failure> {
        let usual = PictureOptions::default();
        let options = PictureOptions {
            width: self.picture_width.unwrap_or(usual.width),
            height: self.picture_height.unwrap_or(usual.height),
            title: self.title.clone(),
            grid: self.grid,
            curvature_profile: self.curvature_profile,
            ..usual
        };
        options.validate().map_err(|error| match &error {
            PictureError::Option { option, value, .. } => {
                Failure::Usage(error.to_string()).about(format!("--picture-{option} {value}"))
            }
            _ => error.into(),
        })?;
        Ok(options)
    }
}

/// The side of a cell of ROS maps.
const RESOLUTION: Setting = Setting::number(
    "resolution",
    "m",
    *RESOLUTIONS.start(),
    *RESOLUTIONS.end(),
    "side of a cell of maps for ROS",
);

/// Whether a file shows what moves in the world.
fn shows_scenario(output: &Output) -> bool {
    matches!(output.format, Format::Scenario | Format::Svg | Format::Png)
}

/// Whether a format uses the resolution.
fn is_gridded(format: Format) -> bool {
    matches!(format, Format::RosMap | Format::HouseExpo)
}

/// Checks the resolution, and that one of the outputs uses it.
fn check_resolution(resolution: Option<f64>, outputs: &[Output]) -> Result<(), Failure> {
    let Some(resolution) = resolution else { return Ok(()) };
    RESOLUTION.check(resolution).in_option("--resolution", resolution)?;
    if outputs.iter().any(|output| is_gridded(output.format)) {
        return Ok(());
    }
    let text =
        "applies to ROS maps and outlines, but no --out ends with .yaml or .house.json".to_owned();
    Err(Failure::Usage(text).about(format!("--resolution {resolution}")))
}

/// Prints the sizes of the ROS maps.
fn say_sizes(world: &World, resolution: Option<f64>, outputs: &[Output]) -> Result<(), Failure> {
    let maps = outputs.iter().filter(|output| output.format == Format::RosMap);
    for map in maps.filter(|output| output.path == output.asked) {
        let usual = usual_resolution(world);
        let side = resolution.unwrap_or(usual);
        let [cols, rows] = size_in_cells(world, side).map_err(|error| {
            Failure::from(error).about(format!("{}, --resolution {side}", option(&map.path)))
        })?;
        let kilobytes = (cols * rows).div_ceil(1000);
        let coarse = if resolution.is_none() && usual > ros_map::RESOLUTION {
            format!(
                "; coarser than {} m because the world is large: see --resolution",
                ros_map::RESOLUTION
            )
        } else {
            String::new()
        };
        let name = map.path.display();
        note(&format!("{name}: {cols} x {rows} cells of {side} m, {kilobytes} kB{coarse}"));
    }
    Ok(())
}

/// How errors name an output.
fn option(path: &Path) -> String {
    format!("--out {}", path.display())
}
