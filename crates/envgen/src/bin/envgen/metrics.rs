//! `envgen metrics`.

use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::import::{ImportedRaster, RasterFileError};
use envgen::landscape::metrics::{Border, RasterReport};

use crate::failure::Failure;

#[derive(Args)]
pub(crate) struct Arguments {
    /// A raster of classes: an ESRI ASCII grid (.asc), an image (.png), a MovingAI map (.map), or
    /// the JSON of a landscape, of a line of `envgen sample` or of a world.
    file: PathBuf,

    /// Prints JSON.
    #[arg(long)]
    json: bool,

    /// Counts the raster's end, and the sides beside cells without data, as edges.
    #[arg(long)]
    border: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let path = &arguments.file;
    let mut file = File::open(path).map_err(|error| Failure::of_file(path, error))?;
    let read = ImportedRaster::read(path, &mut file).map_err(|error| match error {
        RasterFileError::UnknownEnding(_) => Failure::Usage(error.to_string()),
        other => Failure::of_file(path, other),
    })?;
    let border = if arguments.border { Border::Counted } else { Border::Free };
    let mut report =
        RasterReport::new(&read.raster, border).map_err(|error| Failure::of_file(path, error))?;
    if let Some(labels) = &read.labels {
        report = report.labelled(labels);
    }
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    Ok(ExitCode::SUCCESS)
}
