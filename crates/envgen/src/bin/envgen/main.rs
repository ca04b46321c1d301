//! The command `envgen`: generates, converts, samples, inspects and checks worlds.
//!
//! Exit codes: 0 done; 1 a check did not hold, or generation failed; 2 bad arguments, or bad content of a spec, a
//! scenario or a room.

mod check;
mod convert;
mod failure;
mod generate;
mod inspect;
mod kinds;
mod metrics;
mod moving;
mod platform;
mod progress;
mod sample;
mod source;
mod writing;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Generates random worlds for robots, and converts, inspects and checks world files.
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "The command envgen-trials measures the difficulty of worlds, and scores the maps of SLAM programs."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists every kind with its settings, units, defaults and limits.
    Kinds(kinds::Arguments),
    /// Generates one world and writes it to files; the ending of a file's name selects its format.
    Generate(generate::Arguments),
    /// Reads a world file and writes it in other formats; the ending of a file's name selects its format.
    Convert(convert::Arguments),
    /// Prints the blueprints of consecutive seeds, one line of JSON each. Seeds without a blueprint are listed
    /// on stderr; the exit code is then 1.
    Sample(sample::Arguments),
    /// Shows the provenance, certificate, metrics and difficulty vector of a world file.
    Inspect(inspect::Arguments),
    /// Prints the landscape metrics of a raster of classes.
    Metrics(metrics::Arguments),
    /// Verifies the promises of a world file, and that its spec and seed give the same world.
    ///
    /// Every promise of the certificate is verified from the shapes of the world alone. Then the world is generated
    /// again from its spec and seed. The exit code is 1 if a promise does not hold or cannot be decided, or if the
    /// spec and seed give another world. These files pass, with a note: files without promises, imported worlds,
    /// worlds that are marked as edited, worlds of another value version or of other random streams, and files with few
    /// parts whose spec would make very many.
    Check(check::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Kinds(arguments) => kinds::run(&arguments),
        Command::Generate(arguments) => generate::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Sample(arguments) => sample::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Metrics(arguments) => metrics::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
    };
    match done {
        Ok(code) => code,
        Err(failure) => failure.report(),
    }
}
