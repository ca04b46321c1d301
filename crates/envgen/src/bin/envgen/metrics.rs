//! `envgen metrics`.

use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::import::{ImportedRaster, RasterFileError};
use envgen::landscape::metrics::{Border, RasterReport};
use envgen::located::Locate;

use crate::failure::Failure;
use crate::progress::steps;

#[derive(Args)]
pub(crate) struct Arguments {
    /// A raster of classes: an ESRI ASCII grid (.asc), an image (.png), a MovingAI map (.map), or
    /// the JSON of a landscape, of a line of `envgen sample` or of a world.
    file: PathBuf,

    /// Prints JSON.
    #[arg(long)]
    json: bool,

    /// Counts the raster's border, and the sides next to cells without data, as edges.
    #[arg(long)]
    border: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let path = &arguments.file;
    let working = steps(2);
    working.begin("reading");
    let mut file = File::open(path).in_file(path)?;
    let read = ImportedRaster::read(path, &mut file).map_err(|error| match error {
        // The error names the file itself.
        RasterFileError::UnknownEnding(_) => error.into(),
        other => Failure::from(other).about(path.display()),
    })?;
    working.begin("counting");
    let border = if arguments.border { Border::Counted } else { Border::Free };
    let mut report = RasterReport::new(&read.raster, border).in_file(path)?;
    if let Some(labels) = &read.labels {
        report = report.labelled(labels);
    }
    drop(working);
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report)?;
        writeln!(out)?;
    } else {
        write!(out, "{report}")?;
    }
    Ok(ExitCode::SUCCESS)
}
