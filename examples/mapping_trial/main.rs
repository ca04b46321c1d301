//! A robot maps a world that it does not know, and its map is scored against the truth.
//!
//! ```text
//! cargo run --release --example mapping_trial
//! cargo run --release --example mapping_trial -- --difficulty 8 --seed 3 --operator corridors
//! cargo run --release --example mapping_trial -- --replay out/log.json --out out/again
//! ```
//!
//! In the output folder appear the robot's map, the truth and the two over each other as pictures
//! with the ways driven, the map for ROS's `map_server`, the log, from which the trial runs again to
//! the bit, and the report as JSON. Two runs with the same arguments write the same bytes.

#![expect(clippy::print_stdout, reason = "what an example is for")]

mod arguments;
mod output;
mod table;

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, IsTerminal};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use envgen::World;
use indicatif::{ProgressBar, ProgressStyle};
use mapping_trial::feedback::ask;
use mapping_trial::flat::{FlatSimulator, FlatWorld};
use mapping_trial::trial::{Trial, TrialLog};
use mapping_trial::truth::Truth;

use crate::arguments::Arguments;

/// What moves the bodies, as logs and reports name it.
const ENGINE: &str = "flat";

/// Ticks between two looks at the progress bar.
const TICKS_A_LOOK: u64 = 200;

fn main() -> ExitCode {
    match trial(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "where errors are told")]
            {
                eprintln!("error: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Runs a trial, or a log again, and tells what came of it.
fn trial(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = output::folder(&arguments.out)?;

    let clock = now();
    let (world, trial) = match &arguments.replay {
        Some(path) => replay(path)?,
        None => run(arguments)?,
    };
    let seconds = clock.elapsed().as_secs_f64();

    let mut from_start = world.clone();
    from_start.start = trial.track(0).poses.first().copied();
    let truth = Truth::new(&from_start, &trial.settings().body)?;
    let mut report = trial.report(&world, &truth, ENGINE)?;
    table::print(&report);
    println!(
        "\n{:.0} simulated seconds took {seconds:.2} s, {:.0} times as fast as real time",
        trial.time(),
        trial.time() / seconds
    );
    if arguments.form {
        let (mut questions, mut answers) = (std::io::stdout(), std::io::stdin().lock());
        report.feedback = Some(ask(&report.session(), &mut answers, &mut questions)?);
    }
    for path in output::write(folder, &trial, &truth, &report, ENGINE)? {
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// Drives a trial to its end.
fn run(arguments: &Arguments) -> Result<(World, Trial<FlatSimulator>), Box<dyn Error>> {
    let world = arguments.world()?;
    let settings = arguments.settings(&world)?;
    let flat = Arc::new(FlatWorld::new(&world, &settings.body));
    let limit = settings.time_limit.min(settings.body.battery);
    let mut trial = Trial::flat_in(&world, flat, settings)?;
    let bar = progress(limit);
    let mut ticks = 0_u64;
    while trial.step() {
        ticks += 1;
        if ticks.is_multiple_of(TICKS_A_LOOK) {
            bar.set_position(trial.time() as u64);
        }
    }
    bar.finish_and_clear();
    Ok((world, trial))
}

/// Runs a log again.
fn replay(path: &std::path::Path) -> Result<(World, Trial<FlatSimulator>), Box<dyn Error>> {
    let of_file = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = File::open(path).map_err(|error| of_file(&error))?;
    let log = TrialLog::read(&mut BufReader::new(file)).map_err(|error| of_file(&error))?;
    if log.engine != ENGINE {
        let text = format!("engine is `{}`, this example replays `{ENGINE}`", log.engine);
        return Err(of_file(&text).into());
    }
    let world = log.world.world()?;
    Ok((world, log.replay()?))
}

/// A bar of simulated seconds on stderr; nothing where that is no terminal.
fn progress(limit: f64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(limit as u64);
    match ProgressStyle::with_template("{bar:40} {pos}/{len} simulated seconds, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

#[expect(clippy::disallowed_methods, reason = "how long a trial took is told to the terminal only")]
fn now() -> Instant {
    Instant::now()
}
