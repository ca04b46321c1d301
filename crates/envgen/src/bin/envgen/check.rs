//! `envgen check`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::certificate::{Claim, Verdict, verify};
use envgen::reproduction::{Reproduction, reproduce};

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
    let (checked, reproduction) = {
        let _spinner = spinner("checking");
        (verify(&world), reproduce(&world))
    };
    let all_hold = checked.iter().all(|(_, verdict)| *verdict == Verdict::Holds);
    let is_trusted = all_hold && reproduction.is_credible();
    match print(&checked, &reproduction) {
        // A reader that stops after the first line still gets the right exit code.
        Err(Failure::ReaderGone) | Ok(()) => Ok(ExitCode::from(u8::from(!is_trusted))),
        Err(failure) => Err(failure),
    }
}

fn print(checked: &[(Claim, Verdict)], reproduction: &Reproduction) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    writeln!(out, "holds: every invariant of a world")?;
    for (claim, verdict) in checked {
        match verdict.doubt() {
            Some(doubt) => writeln!(out, "{}: {claim} ({doubt})", verdict.name())?,
            None => writeln!(out, "{}: {claim}", verdict.name())?,
        }
    }
    if checked.is_empty() {
        writeln!(out, "nothing promised: the certificate is empty")?;
    }
    writeln!(out, "{reproduction}")?;
    Ok(())
}
