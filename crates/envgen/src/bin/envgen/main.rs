//! The command `envgen`: generates, converts, samples, inspects and checks worlds.
//!
//! Exit codes: 0 done, 1 a check did not hold or generation failed, 2 bad arguments.

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

/// Random worlds for robots: hallways, forests and more, from a kind, its settings and a seed.
#[derive(Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Trials, measured difficulty, and scores of maps that any SLAM made of a world: envgen-trials"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists every kind with its settings, units, defaults and limits.
    Kinds(kinds::Arguments),
    /// Generates one world and writes it to files; the ending of a file selects its format.
    Generate(generate::Arguments),
    /// Reads a world file and writes it in other formats; the endings of the files select them.
    Convert(convert::Arguments),
    /// Prints blueprints of consecutive seeds as JSON lines; seeds without a blueprint are listed on
    /// stderr and give exit code 1.
    Sample(sample::Arguments),
    /// Shows the provenance, certificate, metrics and difficulty vector of a world file.
    Inspect(inspect::Arguments),
    /// Prints the landscape metrics of a raster of classes.
    Metrics(metrics::Arguments),
    /// Checks a world file; exit code 1 if it is not what it claims to be.
    ///
    /// Verifies every promise of the certificate on the world alone, and generates the world again
    /// from its spec and seed. Exit code 1 if a promise does not hold or cannot be decided, or if the
    /// spec and seed give another world. A file without promises, and a world that was imported, marked
    /// as edited or made by another value version, do not fail for that: the output says so.
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
