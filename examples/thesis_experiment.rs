//! Replays the experiment of O. Zwennes, *Adaptive Indoor Map Generator for USARSim* (2011), with
//! exploration policies as operators. Do the rules order maps by difficulty, and if not, which rule is
//! to blame?
//!
//! ```text
//! cargo run --release --example thesis_experiment -- --quick
//! cargo run --release --example thesis_experiment -- --maps 10 --seeds 3
//! ```
//!
//! Every finished trial is written to disk at once, so that the same command continues an interrupted
//! run. The output folder gets `report.html`, `summary.json`, `trials.csv`, `trials.parquet` and
//! `levels.svg`. They are the same to the last byte, whatever the number of threads, and however often
//! the run was interrupted.
//!
//! # Many machines
//!
//! `--shard I/N` runs a share of the trials, and `--merge` merges the shares into the same report. All
//! jobs have the same other arguments:
//!
//! ```text
//! # GNU parallel, here or over ssh
//! parallel -j 2 thesis_experiment --threads 1 --shard {}/4 --out out/part{} ::: 1 2 3 4
//! thesis_experiment --merge out/part1 out/part2 out/part3 out/part4 --out out/all
//!
//! # Slurm: sbatch --array=1-100 --cpus-per-task=4 job.sh
//! thesis_experiment --threads 4 --shard $SLURM_ARRAY_TASK_ID/100 --out parts/$SLURM_ARRAY_TASK_ID
//!
//! # Kubernetes: a Job with completionMode: Indexed and completions: 100, whose indices begin at 0
//! thesis_experiment --shard $((JOB_COMPLETION_INDEX + 1))/100 --out /parts/$JOB_COMPLETION_INDEX
//! ```

#[path = "../crates/mapping_trial/src/bin/envgen-trials/progress.rs"]
mod progress;
#[path = "../crates/mapping_trial/src/bin/envgen-trials/spinner.rs"]
mod spinner;
#[path = "../crates/mapping_trial/src/bin/envgen-trials/stdout.rs"]
mod stdout;
#[path = "shared/trial_arguments.rs"]
mod trial_arguments;

use std::error::Error;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use envgen::Seed;
use envgen::indoor::Profile;
use mapping_trial::experiment::hazards::{self, Hazard};
use mapping_trial::experiment::stats::Interval;
use mapping_trial::experiment::survey::SurveyFolder;
use mapping_trial::experiment::{Design, Experiment, Shard, report};
use mapping_trial::policy::PolicyKind;

use crate::progress::Progress;
use crate::spinner::spinner;
use crate::trial_arguments::{TrialArguments, named};

/// Do the rules of Zwennes (2011) order indoor maps by difficulty? Policies map them, the maps are
/// scored, and a report shows the results.
///
/// The paper's design (levels 1, 3, 5, 7 and 9, two maps each, five policies) always runs; the
/// larger design is set by the options. The same command continues an interrupted run. Policies are crossed
/// with maps; the example `survey` also crosses lasers, odometry and SLAM.
#[derive(Parser)]
#[command(after_long_help = JOBS)]
struct Arguments {
    /// A small design for two minutes: six maps per level, one noise seed, by `nearest`.
    #[arg(long)]
    quick: bool,

    /// Maps per level [default: 20, with --quick 6].
    #[arg(long)]
    maps: Option<u32>,

    /// Noise seeds per map [default: 5, with --quick 1].
    #[arg(long)]
    seeds: Option<u32>,

    /// Levels of difficulty.
    #[arg(long, value_delimiter = ',', default_value = "1,3,5,7,9")]
    levels: Vec<f64>,

    /// Policies of the larger design [default: all but tour, with --quick nearest].
    #[arg(long, alias = "operators", value_delimiter = ',', value_parser = named::<PolicyKind>())]
    policies: Option<Vec<PolicyKind>>,

    /// The thesis's rules exactly, or with the guarantee that every cell is reachable.
    #[arg(long, default_value = "thesis", value_parser = ["thesis", "guaranteed"])]
    profile: String,

    /// Side of the maps in cells of 3 m.
    #[arg(long, default_value_t = Design::default().size)]
    size: u32,

    #[command(flatten)]
    trial: TrialArguments,

    /// The seed of all maps and noise.
    #[arg(long, default_value_t = Seed(0), allow_negative_numbers = true)]
    seed: Seed,

    /// Threads; 0 for one per core.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,

    /// Run only a share of the trials, such as 2/8.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,

    /// Join the folders of all shares instead of running trials.
    #[arg(long, value_name = "FOLDER", num_args = 1.., conflicts_with_all = [
        "quick", "maps", "seeds", "levels", "policies", "profile", "size", "slam", "wheel_calibration", "laser",
        "time_limit", "time_per_area", "seed", "shard", "fresh",
    ])]
    merge: Vec<PathBuf>,

    /// Measure what hazards cost in the same maps: doors, people, smoke, or settings of scenarios such as
    /// people=20. Settings joined by +, such as smoke=0.3+people=20, are one hazard. A table of paired
    /// differences is printed in place of the report; with --merge, that of all shares of such a run.
    #[arg(long, value_delimiter = ',', value_parser = Hazard::parse, conflicts_with = "fresh")]
    hazards: Vec<Hazard>,

    /// Delete an earlier experiment in the folder first.
    #[arg(long)]
    fresh: bool,

    /// The folder to write into.
    #[arg(long, default_value = "out/experiment", value_name = "FOLDER")]
    out: PathBuf,
}

/// The help on running on many machines, which `--help` shows.
const JOBS: &str = "\
On many machines, with the same other options in every job:

  GNU parallel
    parallel -j 2 thesis_experiment --threads 1 --shard {}/4 --out out/part{} ::: 1 2 3 4
    thesis_experiment --merge out/part1 out/part2 out/part3 out/part4 --out out/all
  Slurm (sbatch --array=1-100)
    thesis_experiment --shard $SLURM_ARRAY_TASK_ID/100 --out parts/$SLURM_ARRAY_TASK_ID
  Kubernetes (a Job with completionMode: Indexed and completions: 100)
    thesis_experiment --shard $((JOB_COMPLETION_INDEX + 1))/100 --out /parts/$JOB_COMPLETION_INDEX

The merged report equals that of one run, byte for byte.";

#[expect(clippy::print_stderr, reason = "errors go to stderr")]
fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let threads = usize::from(arguments.threads);
    if let Some(first) = arguments.merge.first() {
        if !arguments.hazards.is_empty() {
            // This is checked before anything is written.
            hazards::check(&SurveyFolder::survey_of(first)?, &arguments.hazards)?;
            let folder = SurveyFolder::merge(&arguments.out, &arguments.merge)?;
            return print_costs(&arguments.hazards, &folder);
        }
        if SurveyFolder::survey_of(first).is_ok() {
            let first = first.display();
            let error =
                format!("{first}: the share measured what hazards cost: give its --hazards");
            return Err(error.into());
        }
        let experiment = Experiment::merge(&arguments.out, &arguments.merge)?;
        return write_report(&experiment, threads);
    }
    let (design, shard) = (arguments.design(), arguments.shard);
    if !arguments.hazards.is_empty() {
        return cost(arguments, &design);
    }
    let begin = if arguments.fresh { Experiment::fresh } else { Experiment::open };
    let mut experiment = begin(&arguments.out, &design, shard)?;
    announce(&experiment)?;
    let bar = Progress::new();
    bar.set("trials", experiment.records().len() as u64, experiment.trials() as u64);
    let result = experiment.run(threads, &|progress| {
        bar.set("trials", progress.done as u64, progress.all as u64);
        ControlFlow::Continue(())
    });
    bar.finish();
    result?;
    if shard == Shard::WHOLE {
        return write_report(&experiment, threads);
    }
    say_finished(shard, experiment.folder())
}

/// Prints that a share is finished, since its results are not those of all trials.
fn say_finished(shard: Shard, folder: &Path) -> Result<(), Box<dyn Error>> {
    Ok(stdout::print(&format!("share {shard} is finished: {}\n", folder.display()))?)
}

/// Runs the maps with and without each hazard, and prints the cost of each; for a share, prints that it
/// is finished.
fn cost(arguments: &Arguments, design: &Design) -> Result<(), Box<dyn Error>> {
    let hazards = &arguments.hazards;
    let survey = hazards::survey(design, hazards)?;
    let mut folder = SurveyFolder::open(&arguments.out, &survey, arguments.shard)?;
    let bar = Progress::new();
    bar.set("trials", folder.records().len() as u64, folder.trials());
    let result = folder.run(usize::from(arguments.threads), &|progress| {
        bar.set("trials", progress.done, progress.all);
        ControlFlow::Continue(())
    });
    bar.finish();
    result?;
    if arguments.shard != Shard::WHOLE {
        return say_finished(arguments.shard, &arguments.out);
    }
    print_costs(hazards, &folder)
}

/// Prints the cost of each hazard.
fn print_costs(hazards: &[Hazard], folder: &SurveyFolder) -> Result<(), Box<dyn Error>> {
    let survey = folder.survey();
    let width = hazards.iter().map(|hazard| hazard.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    writeln!(
        text,
        "{:>width$} maps  D more             M more             N more             collisions with people  ghosts",
        ""
    )
    .ok();
    for cost in hazards::costs(survey, hazards, folder.records()) {
        let more =
            |one: Interval| format!("{:+5.2} [{:+.2}, {:+.2}]", one.value, one.low, one.high);
        writeln!(
            text,
            "{:>width$} {:4}  {} {} {} {:22.1} {:7.1} m^2",
            cost.hazard,
            cost.maps,
            more(cost.difficulty),
            more(cost.mapping),
            more(cost.navigation),
            cost.person_collisions,
            cost.ghost_area
        )
        .ok();
    }
    writeln!(text, "wrote {}", folder.file().display()).ok();
    Ok(stdout::print(&text)?)
}

impl Arguments {
    fn design(&self) -> Design {
        let design = if self.quick { Design::quick() } else { Design::default() };
        let maps = self.maps.unwrap_or(design.maps);
        let mut replay = design.replay;
        replay.maps = replay.maps.min(maps);
        Design {
            levels: self.levels.clone(),
            maps,
            noise_seeds: self.seeds.unwrap_or(design.noise_seeds),
            policies: self.policies.clone().unwrap_or(design.policies),
            replay,
            profile: if self.profile == "thesis" { Profile::Thesis } else { Profile::Guaranteed },
            size: self.size,
            slam: self.trial.slam,
            wheel_calibration: self.trial.wheel_calibration,
            laser: self.trial.laser.clone(),
            time_limit: self.trial.time_limit,
            time_per_area: self.trial.time_per_area,
            seed: self.seed,
            ..design
        }
    }
}

/// Prints how many trials there are to run.
fn announce(experiment: &Experiment) -> Result<(), Box<dyn Error>> {
    let (design, all) = (experiment.design(), experiment.trials());
    let done = experiment.records().len();
    let share = match experiment.shard() {
        Shard::WHOLE => String::new(),
        shard => format!(" of share {shard}"),
    };
    let mut text = String::new();
    writeln!(
        text,
        "{all} trials{share}: {} levels x {} maps x {} noise seeds x {} policies, and the paper's \
         {} maps per level by {} policies",
        design.levels.len(),
        design.maps,
        design.noise_seeds,
        design.policies.len(),
        design.replay.maps,
        design.replay.policies.len(),
    )
    .ok();
    if done > 0 {
        writeln!(text, "{done} of them were finished before, in {}", experiment.folder().display())
            .ok();
    }
    Ok(stdout::print(&text)?)
}

fn write_report(experiment: &Experiment, threads: usize) -> Result<(), Box<dyn Error>> {
    let writing = spinner("writing the report");
    let paths = report::write(experiment, threads)?;
    writing.finish_and_clear();
    let wrote = paths.iter().map(|path| format!("wrote {}\n", path.display()));
    Ok(stdout::print(&wrote.collect::<String>())?)
}
