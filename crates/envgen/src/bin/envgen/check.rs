//! `envgen check`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::certificate::{Claim, Verdict, verify};

use crate::failure::Failure;
use crate::progress::spinner;
use crate::source::WorldFile;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    file: WorldFile,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let world = arguments.file.read()?;
    let checked = {
        let _spinner = spinner("checking");
        verify(&world)
    };
    let all_hold = checked.iter().all(|(_, verdict)| *verdict == Verdict::Holds);
    match print(&checked) {
        // Who reads only the first line still wants the right exit code.
        Err(Failure::ReaderGone) | Ok(()) => Ok(ExitCode::from(u8::from(!all_hold))),
        Err(failure) => Err(failure),
    }
}

fn print(checked: &[(Claim, Verdict)]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "holds: every invariant of a world")?;
    for (claim, verdict) in checked {
        let word = match verdict {
            Verdict::Holds => "holds",
            Verdict::Broken => "broken",
            Verdict::Undecided => "undecided",
        };
        writeln!(out, "{word}: {claim}")?;
    }
    Ok(())
}
