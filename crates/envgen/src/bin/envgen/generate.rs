//! `envgen generate`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use envgen::export::ros_map::{self, RESOLUTIONS, size_in_cells, usual_resolution};
use envgen::export::{Format, Job, Output};
use envgen::located::Locate;
use envgen::picture::{PictureError, PictureOptions};
use envgen::settings::Setting;
use envgen::whole_file::commit_all;
use envgen::{World, WorldMetrics};

use crate::failure::Failure;
use crate::moving::Moving;
use crate::progress::spinner;
use crate::source::{Source, note};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// A file to write; its ending selects the format. May be given several times.
    #[arg(long, required = true, value_name = "FILE")]
    out: Vec<PathBuf>,

    /// Cell size of ROS maps (.yaml) in metres, from 0.001 to 1000; a map has at most 67,108,864 cells.
    /// Default: 0.05, or coarser for a world that would have more than 16,777,216 cells.
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    resolution: Option<f64>,

    #[command(flatten)]
    moving: Moving,

    #[command(flatten)]
    picture: Picture,
}

/// How pictures are drawn.
#[derive(Args)]
#[command(next_help_heading = "Pictures")]
struct Picture {
    /// Greatest width of pictures in px.
    #[arg(long, value_name = "PX", allow_negative_numbers = true,
          default_value_t = PictureOptions::default().width)]
    picture_width: u32,

    /// Greatest height of the plan in pictures in px.
    #[arg(long, value_name = "PX", allow_negative_numbers = true,
          default_value_t = PictureOptions::default().height)]
    picture_height: u32,

    /// Title of pictures, instead of kind and seed.
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,

    /// Draws a grid of round metres under the world.
    #[arg(long)]
    grid: bool,

    /// Draws the curvature of roads over their length, under the world.
    #[arg(long)]
    curvature_profile: bool,
}

impl Picture {
    fn options(&self) -> Result<PictureOptions, Failure> {
        let options = PictureOptions {
            width: self.picture_width,
            height: self.picture_height,
            title: self.title.clone(),
            grid: self.grid,
            curvature_profile: self.curvature_profile,
            ..Default::default()
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

/// Checks the resolution, and that one of the outputs uses it.
fn check_resolution(resolution: Option<f64>, outputs: &[Output]) -> Result<(), Failure> {
    let Some(resolution) = resolution else { return Ok(()) };
    RESOLUTION.check(resolution).in_option("--resolution", resolution)?;
    if outputs.iter().any(|output| output.format == Format::RosMap) {
        return Ok(());
    }
    let text = "applies to ROS maps, but no --out ends with .yaml".to_owned();
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

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    // All mistakes in the arguments are found before any work is done.
    let source = &arguments.source;
    let (spec, moving) = source.spec_and_scenario()?;
    let mut picture = arguments.picture.options()?;
    let outputs =
        Output::all(&arguments.out, &[source.inputs(), arguments.moving.inputs()].concat())?;
    let resolution = arguments.resolution;
    check_resolution(resolution, &outputs)?;
    let mut files = Vec::new();
    for output in &outputs {
        files.push(output.create()?);
    }
    let _spinner = spinner("generating");
    let blueprint = spec.generate(source.seed).map_err(|error| source.name(error.into()))?;
    let world = blueprint.to_world();
    let scenario = arguments.moving.scenario(&world, moving, source.seed)?;
    picture.scenario.clone_from(&scenario);
    say_sizes(&world, resolution, &outputs)?;
    for (output, file) in outputs.iter().zip(&mut files) {
        let job = Job {
            blueprint: Some(&blueprint),
            resolution,
            scenario: scenario.as_ref(),
            picture: picture.clone(),
            ..Job::for_path(&world, &output.asked)
        };
        output.write(&job, file)?;
    }
    commit_all(files).map_err(|error| Failure::from(error).about("--out"))?;
    if let WorldMetrics::Landscape(metrics) = blueprint.metrics()
        && let Some(error) = metrics.total_edge_error.filter(|error| *error != 0)
    {
        note(&format!("no landscape of this total_edge was found; the nearest is {error:+} off"));
    }
    Ok(ExitCode::SUCCESS)
}
