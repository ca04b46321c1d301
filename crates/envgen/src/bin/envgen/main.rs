//! The command `envgen`: generates, samples, inspects and checks worlds.
//!
//! Exit codes: 0 done, 1 a check did not hold or generation failed, 2 bad arguments.

mod check;
mod failure;
mod generate;
mod inspect;
mod kinds;
mod metrics;
mod progress;
mod sample;
mod source;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Random worlds for robots: hallways, forests and more, from a kind, its settings and a seed.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// CellBuckets every kind with its settings, units, defaults and limits.
    Kinds(kinds::Arguments),
    /// Generates one world and writes it to files; the format follows a file's ending.
    Generate(generate::Arguments),
    /// Prints blueprints of consecutive seeds as JSON lines; seeds that have none are named on
    /// stderr and make the exit code 1.
    Sample(sample::Arguments),
    /// Tells what a world file holds: provenance, certificate, metrics.
    Inspect(inspect::Arguments),
    /// Measures a raster of classes as landscape ecology does.
    Metrics(metrics::Arguments),
    /// Says whether a world file can be trusted; exit code 1 if it cannot.
    ///
    /// Verifies every promise of the certificate on the world alone, and generates the world again
    /// from its spec and seed. Exit code 1 if a promise does not hold or cannot be decided, or if the
    /// spec and seed do not make this world. A file that promises nothing, was imported, says that it
    /// was edited, or was made by another version of its kind's values is not failed for that: the
    /// output says so.
    Check(check::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Kinds(arguments) => kinds::run(&arguments),
        Command::Generate(arguments) => generate::run(&arguments),
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
