//! `envgen check`.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use envgen::certificate::{Verdict, verify};

use crate::failure::Failure;
use crate::source::read_world;

#[derive(Args)]
pub(crate) struct Arguments {
    /// A world file, JSON or RON.
    file: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let world = read_world(&arguments.file)?;
    let mut out = io::stdout().lock();
    let mut broken = false;
    writeln!(out, "holds: every invariant of a world")?;
    for (claim, verdict) in verify(&world) {
        let word = match verdict {
            Verdict::Holds => "holds",
            Verdict::Broken => "broken",
            Verdict::Undecided => "undecided",
        };
        broken |= verdict == Verdict::Broken;
        writeln!(out, "{word}: {claim}")?;
    }
    Ok(ExitCode::from(u8::from(broken)))
}
