//! Runs a trial: a robot maps a world that it does not know, and its map is scored against the world.
//!
//! ```text
//! cargo run --release --example mapping_trial
//! cargo run --release --example mapping_trial -- --difficulty 8 --seed 3 --policy corridors
//! cargo run --release --example mapping_trial -- --engine rapier --set doors=0.5 --set people=4
//! cargo run --release --example mapping_trial -- --driver "python3 examples/drivers/explorer.py"
//! cargo run --release --example mapping_trial -- --replay out/log.json --out out/again
//! cargo run --release --example mapping_trial -- --log out/bag/trial.mcap
//! cargo run --release --features window --example mapping_trial -- --engine rapier --camera out/frames
//! ```
//!
//! The output folder gets pictures of the robot's map, of the mappable area and of their differences,
//! with trajectories; the map for ROS's `map_server`; the log, by which the trial is replayed to the
//! last bit; and the report as JSON. `--log` also writes a bag for ROS 2, and `--camera` the images of
//! the robots' cameras. Two runs with the same arguments write the same bytes.

mod arguments;
mod bag;
#[cfg_attr(not(feature = "render"), path = "no_camera.rs")]
mod camera;
mod driver;
#[path = "../shared/moving.rs"]
mod moving;
#[path = "../shared/output.rs"]
mod output;
#[path = "../shared/robot.rs"]
mod robot;
#[path = "../shared/spec_file.rs"]
mod spec_file;
#[path = "../../crates/mapping_trial/src/bin/envgen-trials/spinner.rs"]
mod spinner;
#[path = "../shared/start.rs"]
mod start;
#[path = "../../crates/mapping_trial/src/bin/envgen-trials/start_argument.rs"]
mod start_argument;
mod table;
#[path = "../shared/trial_arguments.rs"]
mod trial_arguments;
#[path = "../shared/trial_bar.rs"]
mod trial_bar;

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use envgen::World;
use envgen::located::{Locate, Located};
use envgen::scenario::Scenario;
use indicatif::ProgressBar;
use mapping_trial::backend::{RobotBackend, TICK};
use mapping_trial::driver::Driver;
use mapping_trial::feedback::ask;
use mapping_trial::flat::FlatSimulator;
use mapping_trial::score::Reference;
use mapping_trial::trial::{
    ForeignPart, PartRole, Trial, TrialBuilder, TrialLog, TrialParts, TrialReport, TrialSettings,
};

use crate::arguments::Arguments;
use crate::bag::Bag;
use crate::spinner::spinner;
use crate::trial_bar::trial_bar;

/// Name of the flat simulator in logs and reports.
const FLAT: &str = FlatSimulator::ENGINE;

/// Name of Rapier in logs and reports.
const RAPIER: &str = bevy_mapping_trial::trial::ENGINE;

/// Number of ticks between two updates of the progress bar.
const TICKS_A_LOOK: u64 = 200;

fn main() -> ExitCode {
    match trial(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            #[expect(clippy::print_stderr, reason = "errors go to stderr")]
            {
                eprintln!("error: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Runs a trial, or replays a log, and prints the results.
fn trial(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    camera::check(arguments)?;
    output::folder(&arguments.out)?;
    arguments.check_outputs()?;
    let clock = now();
    let Some(path) = &arguments.replay else {
        refuse_camera_of(arguments, &arguments.engine)?;
        let preparing = spinner("preparing");
        let world = arguments.world()?;
        let settings = arguments.settings(&world)?;
        let scenario = arguments.scenario(&world, settings.start)?;
        let mut builder = Trial::builder(&world, settings);
        if let Some(scenario) = &scenario {
            // Robots start beside people.
            builder = builder.scenario(scenario.clone());
        }
        let setup = builder.setup()?;
        // A trial that cannot be scored is not run.
        let start = setup.starts[0].position;
        let truth = Reference::from_start(&world, &setup.settings.body, start)?;
        // The settings have the time limit in effect, which may depend on the area.
        let settings = setup.settings.clone();
        let bag = arguments.bag(settings.robots)?;
        let driver = arguments.start_driver(&setup)?;
        let parts = driver.as_ref().map_or_else(TrialParts::default, Driver::parts);
        let parts = watched(bag.as_ref(), parts);
        preparing.finish_and_clear();
        let bar = trial_bar(settings.time_limit.min(settings.body.battery));
        let report = if arguments.engine == RAPIER {
            let progress = |time| bar.set_position(time as u64);
            let moving = (parts, scenario);
            let (trial, pictures) = camera::run(arguments, &world, settings, moving, progress)?;
            bar.finish_and_clear();
            tell(arguments, &world, (&trial, &truth), (bag, pictures), clock)?
        } else {
            let trial = run_flat(&world, settings, parts, scenario, &bar)?;
            tell(arguments, &world, (&trial, &truth), (bag, Vec::new()), clock)?
        };
        let mut failure = report.failure.clone();
        if let Some(driver) = driver {
            driver.end(Some(&report));
            failure = failure.or(driver.failure());
        }
        return match failure {
            Some(failure) => Err(format!("the driver failed: {failure}").into()),
            None => Ok(()),
        };
    };
    let file = File::open(path).in_file(path)?;
    let log = TrialLog::read(&mut BufReader::new(file)).in_file(path)?;
    refuse_camera_of(arguments, &log.engine)?;
    let bag = arguments.bag(log.settings.robots)?;
    let world = log.world.world().in_file(path)?;
    for part in log.foreign.iter().filter(|part| part.role != PartRole::Policy) {
        say(arguments, format_args!("{}\n", missing(part)))?;
    }
    let parts = watched(bag.as_ref(), TrialParts::default());
    let bar = trial_bar(log.ticks() as f64 * TICK);
    match log.engine.as_str() {
        FLAT => {
            let build = |builder: TrialBuilder<'_>| builder.parts(parts).build_flat();
            let mut trial = log.replay_with(&world, build).in_file(path)?;
            let progress = |trial: &Trial<FlatSimulator>| bar.set_position(trial.time() as u64);
            log.run_through_with(&mut trial, progress).in_file(path)?;
            bar.finish_and_clear();
            let truth = trial.reference(&world)?;
            tell(arguments, &world, (&trial, &truth), (bag, Vec::new()), clock)?
        }
        RAPIER => {
            let progress = |time| bar.set_position(time as u64);
            let replayed = camera::replay(arguments, &world, log, parts, progress);
            let (trial, pictures) = replayed.in_file(path)?;
            bar.finish_and_clear();
            let truth = trial.reference(&world)?;
            tell(arguments, &world, (&trial, &truth), (bag, pictures), clock)?
        }
        other => {
            let text = format!("unknown engine `{other}`, expected `{FLAT}` or `{RAPIER}`");
            return Ok(Err(text).in_file(path)?);
        }
    };
    Ok(())
}

/// Rejects cameras for an engine whose robots have none.
fn refuse_camera_of(arguments: &Arguments, engine: &str) -> Result<(), Box<dyn Error>> {
    if arguments.camera.is_some() && engine != RAPIER {
        return Err(format!("--camera needs --engine {RAPIER}, got {engine}").into());
    }
    Ok(())
}

/// Returns the parts of a trial, with the recorder of its bag if there is one.
fn watched(bag: Option<&Bag>, parts: TrialParts) -> TrialParts {
    match bag {
        Some(bag) => bag.watch(parts),
        None => parts,
    }
}

/// Returns the notice that a built-in part replaces a part that was plugged in. A policy's commands are
/// in the log.
fn missing(part: &ForeignPart) -> String {
    let ForeignPart { role, name } = part;
    format!(
        "the log's {} `{name}` is not part of this program: the built-in one replaces it",
        role.text()
    )
}

/// Prints the results of a trial that took `seconds`, and writes its files.
fn tell<B: RobotBackend>(
    arguments: &Arguments,
    world: &World,
    (trial, truth): (&Trial<B>, &Reference),
    (bag, pictures): (Option<Bag>, Vec<PathBuf>),
    clock: Instant,
) -> Result<TrialReport, Box<dyn Error>> {
    let seconds = clock.elapsed().as_secs_f64();
    let scoring = spinner("scoring");
    let mut report = trial.report(world, truth)?;
    scoring.finish_and_clear();
    let writing = spinner("writing");
    let mut paths = output::write(&arguments.out, trial, truth, &report)?;
    writing.finish_and_clear();
    // The form comes before the scores, which would influence the ratings. The pictures may be looked
    // at.
    let asked = arguments.form.then(|| -> Result<_, Box<dyn Error>> {
        say(arguments, format_args!("the pictures are in {}\n", arguments.out.display()))?;
        let (mut questions, mut answers) = (std::io::stdout(), std::io::stdin().lock());
        Ok(ask(&report.session(), &mut answers, &mut questions)?)
    });
    if let Some(Ok(feedback)) = &asked {
        report.feedback = Some(feedback.clone());
        paths = output::write(&arguments.out, trial, truth, &report)?;
    }
    // The files are complete, whatever happens to the form and the table.
    if let Some(bag) = bag {
        paths.extend(bag.finish(trial, world, &report)?);
    }
    asked.transpose()?;
    say(
        arguments,
        format_args!(
            "{}\n{:.0} simulated seconds took {seconds:.2} s, {:.0} times as fast as real time\n",
            table::table(&report),
            trial.time(),
            trial.time() / seconds
        ),
    )?;
    paths.extend(pictures);
    for path in paths {
        say(arguments, format_args!("wrote {}\n", path.display()))?;
    }
    Ok(report)
}

/// Prints to stdout, or to stderr if stdout belongs to a driver. It is no error if the reader closes
/// early, as `head` does: the files are still written.
fn say(
    arguments: &Arguments,
    text: std::fmt::Arguments<'_>,
) -> Result<(), Located<std::io::Error>> {
    let (said, place) = if arguments.is_driven_by_caller() {
        (std::io::stderr().write_fmt(text), "stderr")
    } else {
        (std::io::stdout().write_fmt(text), "stdout")
    };
    match said {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Located { place: place.to_owned(), error })
        }
        _ => Ok(()),
    }
}

/// Runs a trial of the flat simulator to its end.
fn run_flat(
    world: &World,
    settings: TrialSettings,
    parts: TrialParts,
    scenario: Option<Scenario>,
    bar: &ProgressBar,
) -> Result<Trial<FlatSimulator>, Box<dyn Error>> {
    let mut builder = Trial::builder(world, settings).parts(parts);
    if let Some(scenario) = scenario {
        builder = builder.scenario(scenario);
    }
    let mut trial = builder.build_flat()?;
    let mut ticks = 0_u64;
    while trial.step() {
        ticks += 1;
        if ticks.is_multiple_of(TICKS_A_LOOK) {
            bar.set_position(trial.time() as u64);
        }
    }
    bar.finish_and_clear();
    Ok(trial)
}

#[expect(clippy::disallowed_methods, reason = "how long a trial took is only printed")]
fn now() -> Instant {
    Instant::now()
}
