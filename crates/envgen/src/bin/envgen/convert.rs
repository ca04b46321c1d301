//! `envgen convert`.

use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;
use crate::progress::spinner;
use crate::source::WorldFile;
use crate::writing::Writing;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    file: WorldFile,

    #[command(flatten)]
    writing: Writing,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let files = arguments.writing.begin(&arguments.file.inputs())?;
    let world = arguments.file.read()?;
    let _spinner = spinner("writing");
    files.write(&world, None)?;
    Ok(ExitCode::SUCCESS)
}
