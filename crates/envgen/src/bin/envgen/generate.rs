//! `envgen generate`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::WorldMetrics;
use envgen::export::{Format, Job};
use envgen::picture::PictureOptions;

use crate::failure::Failure;
use crate::output::Pending;
use crate::progress::spinner;
use crate::source::{Source, note};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// A file to write; its ending names the format. May be given several times.
    #[arg(long, required = true, value_name = "FILE")]
    out: Vec<PathBuf>,

    #[command(flatten)]
    picture: Picture,
}

/// How pictures are drawn.
#[derive(Args)]
#[command(next_help_heading = "Pictures")]
struct Picture {
    /// Greatest width in px.
    #[arg(long, value_name = "PX", default_value_t = PictureOptions::default().width)]
    picture_width: u32,

    /// Greatest height of the plan in px.
    #[arg(long, value_name = "PX", default_value_t = PictureOptions::default().height)]
    picture_height: u32,

    /// The text above the world, in place of kind and seed.
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
        options.validate().map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(options)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    // Everything that can be wrong with the arguments is found before any work is done.
    let spec = arguments.source.spec()?;
    let picture = arguments.picture.options()?;
    let mut formats = Vec::new();
    for path in &arguments.out {
        formats.push((path, Format::from_path(path)?));
    }
    let _spinner = spinner("generating");
    let blueprint = spec.generate(arguments.source.seed)?;
    let world = blueprint.to_world();
    let mut pending = Pending::default();
    for (path, format) in formats {
        let job = Job {
            blueprint: Some(&blueprint),
            picture: picture.clone(),
            ..Job::for_path(&world, path)
        };
        for (i, (ending, write)) in format.files().iter().enumerate() {
            // The first file keeps the name as it was given, capitals and all.
            let path = if i == 0 { path.clone() } else { path.with_extension(ending) };
            pending.write(&path, |out| Ok(write(&job, out)?))?;
        }
    }
    pending.commit()?;
    if let WorldMetrics::Landscape(metrics) = blueprint.metrics()
        && let Some(error) = metrics.total_edge_error.filter(|error| *error != 0)
    {
        note(&format!("no landscape has this total_edge; the nearest is {error:+} off"));
    }
    Ok(ExitCode::SUCCESS)
}
