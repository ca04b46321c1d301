//! `envgen convert`.

use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;
use crate::progress::steps;
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
    let files = arguments.writing.begin_without_plan(&arguments.file.inputs())?;
    let steps = steps(1 + files.count());
    steps.begin("reading");
    let world = arguments.file.read()?;
    files.write(&world, None, &steps)?;
    Ok(ExitCode::SUCCESS)
}
