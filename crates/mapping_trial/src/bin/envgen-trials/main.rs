//! The command `envgen-trials`, which measures how difficult worlds are, generates worlds of a measured
//! difficulty, and scores maps from elsewhere.
//!
//! Exit codes: 0 success, 1 failure, 2 invalid arguments or invalid content of a robot, profile or panel.

mod anchors;
mod atlas;
mod calibrate;
mod generate;
mod json;
mod levers;
mod link;
mod measure;
mod panel;
mod progress;
mod score;
mod spinner;
mod start_argument;
mod stdout;
mod survey;
mod trajectory_gaps;
mod usage;
mod warning;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Measures the difficulty of worlds by mapping trials of simulated robots, and scores maps of other SLAM programs.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,

    /// Number of threads; 0 for one per core.
    #[arg(long, global = true, default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,
}

#[derive(Subcommand)]
enum Command {
    /// Measures the difficulty of a world file or a ROS map.
    Measure(measure::Arguments),
    /// Generates an indoor map of a requested difficulty: measures several candidates, and measures the best one
    /// again.
    Generate(generate::Arguments),
    /// Measures the effect of each lever, a setting that makes maps easier or harder.
    Levers(levers::Arguments),
    /// Scores the map that a SLAM program made of a world, and its trajectory, by the scores of trials.
    Score(score::Arguments),
    /// Fits people's ratings to the scale of measured difficulty, from the reports of their sessions.
    Link(link::Arguments),
    /// Measures the anchors, the easy and hard worlds that define the scale of a panel.
    Anchors(anchors::Arguments),
    /// Measures the worlds of an atlas, to which predictions are fitted.
    Atlas(atlas::Arguments),
    /// Fits the predictions of difficulty to a measured atlas.
    Calibrate(calibrate::Arguments),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            warning::print(&format!("error: {error}"));
            ExitCode::from(if usage::is_usage(&*error) { 2 } else { 1 })
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let threads = usize::from(arguments.threads);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    match &arguments.command {
        Command::Measure(arguments) => measure::run(arguments, threads),
        Command::Generate(arguments) => generate::run(arguments, threads),
        Command::Levers(arguments) => levers::run(arguments, threads),
        Command::Score(arguments) => score::run(arguments),
        Command::Link(arguments) => link::run(arguments),
        Command::Anchors(arguments) => anchors::run(arguments, threads),
        Command::Atlas(arguments) => atlas::run(arguments, threads),
        Command::Calibrate(arguments) => calibrate::run(arguments),
    }
}
