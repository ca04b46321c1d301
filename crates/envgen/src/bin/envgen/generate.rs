//! `envgen generate`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::export::{Format, Job};

use crate::failure::Failure;
use crate::output::Pending;
use crate::source::Source;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// A file to write; its ending names the format. May be given several times.
    #[arg(long, required = true, value_name = "FILE")]
    out: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    // Everything that can be wrong with the arguments is found before any work is done.
    let spec = arguments.source.spec()?;
    let mut formats = Vec::new();
    for path in &arguments.out {
        formats.push((path, Format::from_path(path)?));
    }
    let world = spec.generate(arguments.source.seed)?.to_world();
    let mut pending = Pending::default();
    for (path, format) in formats {
        let job = Job::for_path(&world, path);
        for (i, (ending, write)) in format.files().iter().enumerate() {
            // The first file keeps the name as it was given, capitals and all.
            let path = if i == 0 { path.clone() } else { path.with_extension(ending) };
            pending.write(&path, |out| Ok(write(&job, out)?))?;
        }
    }
    pending.commit()?;
    Ok(ExitCode::SUCCESS)
}
