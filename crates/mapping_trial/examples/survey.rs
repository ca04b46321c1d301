//! Runs the trials of a survey in RON, which has several conditions in many worlds. Prints how they
//! ended, and how much of the variance of each score is due to the worlds.
//!
//! ```text
//! cargo run --release --example survey -- assets/surveys/ends.survey.ron --out out/ends
//! ```
//!
//! Every finished trial is written to disk at once, so that the same command continues an interrupted
//! run. The output folder gets `trials.jsonl`, `summary.json` and `ranks.csv`, which has the order of
//! the worlds by score 1 and by score 2.
//!
//! `--shard I/N` runs a share of the worlds, each in a folder of its own, and `--merge` joins them:
//!
//! ```text
//! survey my.survey.ron --shard 1/2 --out out/part1
//! survey my.survey.ron --shard 2/2 --out out/part2
//! survey my.survey.ron --merge out/part1 out/part2 --out out/all
//! ```

#[path = "../src/bin/envgen-trials/progress.rs"]
mod progress;
#[path = "../src/bin/envgen-trials/stdout.rs"]
mod stdout;

use std::error::Error;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use envgen::text_file;
use envgen::whole_file;
use mapping_trial::experiment::stats::Interval;
use mapping_trial::experiment::survey::summary::{Means, Summary, summarise};
use mapping_trial::experiment::survey::{Survey, SurveyFolder};
use mapping_trial::experiment::{ExperimentError, Shard};

use crate::progress::Progress;

/// Runs trials under several conditions in many worlds, and prints how they ended and which part of
/// each score's variance belongs to the worlds.
///
/// The same command continues an interrupted run.
#[derive(Parser)]
struct Arguments {
    /// The survey: families of worlds and conditions, in RON.
    survey: PathBuf,

    /// Threads; 0 for one per core.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,

    /// Run only a share of the worlds, such as 2/8.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,

    /// Join the folders of all shares of the survey, instead of running trials.
    #[arg(long, value_name = "FOLDER", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,

    /// How many faulty trials to list per kind.
    #[arg(long, default_value_t = 20)]
    faults: usize,

    /// The folder to write into.
    #[arg(long, default_value = "out/survey", value_name = "FOLDER")]
    out: PathBuf,
}

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
    let survey = read(&arguments.survey)?;
    let folder = if arguments.merge.is_empty() {
        let mut folder = SurveyFolder::open(&arguments.out, &survey, arguments.shard)?;
        let (all, finished) = (folder.trials(), folder.records().len());
        stdout::print(&format!("{all} trials, {finished} finished before\n"))?;
        let bar = Progress::new();
        bar.set("trials", folder.records().len() as u64, folder.trials());
        let result = folder.run(usize::from(arguments.threads), &|progress| {
            bar.set("trials", progress.done, progress.all);
            ControlFlow::Continue(())
        });
        bar.finish();
        result?;
        folder
    } else {
        SurveyFolder::merge_of(&survey, &arguments.out, &arguments.merge)?
    };
    let records: Vec<_> = folder.records().collect();
    let summary = summarise(&survey, &records);
    let mut printed = tables(&summary, arguments.faults);
    let path = arguments.out.join("summary.json");
    let text = serde_json::to_vec_pretty(&summary)
        .map_err(|error| ExperimentError::Report(error.to_string()))?;
    write(&path, &text)?;
    writeln!(printed, "wrote {} and {}", folder.file().display(), path.display()).ok();
    if let Some(ranks) = &summary.ranks {
        let path = arguments.out.join("ranks.csv");
        write(&path, &ranks.csv()?)?;
        writeln!(printed, "wrote {}", path.display()).ok();
    }
    Ok(stdout::print(&printed)?)
}

fn read(path: &Path) -> Result<Survey, ExperimentError> {
    let text = text_file::read(path)
        .map_err(|source| ExperimentError::File { path: path.to_owned(), source })?;
    Survey::from_ron(&text).map_err(|error| ExperimentError::Content {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

fn write(path: &Path, text: &[u8]) -> Result<(), ExperimentError> {
    whole_file::write(path, text)
        .map_err(|error| ExperimentError::File { path: path.to_owned(), source: error.error })
}

/// The tables of a summary, and its first faults of each kind.
fn tables(summary: &Summary, faults: usize) -> String {
    let mut text = String::new();
    writeln!(
        text,
        "\n{:>40} trials     D     M     N    D1    M1    N1     C   time  ATE median, 90 %  ends",
        ""
    )
    .ok();
    for group in &summary.groups {
        let name = format!("{}, {}", group.family, group.condition);
        let ends: Vec<String> =
            group.ends.iter().map(|(end, n)| format!("{} {n}", end.text())).collect();
        let number = |value: Option<f64>, width: usize, decimals: usize| match value {
            Some(value) => format!("{value:width$.decimals$}"),
            None => format!("{:>width$}", "-"),
        };
        let mean = |of: fn(&Means) -> f64, width, decimals| {
            number(group.mean.as_ref().map(of), width, decimals)
        };
        writeln!(
            text,
            "{name:>40} {:6} {} {} {} {} {} {} {} {} {} {}  {}",
            group.trials,
            mean(|mean| mean.difficulty, 5, 2),
            mean(|mean| mean.mapping, 5, 2),
            mean(|mean| mean.navigation, 5, 2),
            mean(|mean| mean.score_1[0], 5, 2),
            mean(|mean| mean.score_1[1], 5, 2),
            mean(|mean| mean.score_1[2], 5, 2),
            mean(|mean| mean.coverage, 5, 3),
            mean(|mean| mean.time, 6, 0),
            number(group.median_error, 8, 2),
            number(group.high_error, 8, 2),
            ends.join(", ")
        )
        .ok();
    }
    for measure in &summary.measures {
        let shares = measure.components.components.iter();
        let shares = shares.map(|one| {
            let Interval { value, low, high } = one.share;
            let [value, low, high] = [value, low, high].map(|share| 100.0 * share);
            format!("{} {value:.0} % [{low:.0}, {high:.0}]", one.effect)
        });
        let shares: Vec<String> = shares.collect();
        let ratio = measure.components.signal_to_noise.map_or_else(String::new, |ratio| {
            format!("{:.2} [{:.2}, {:.2}]", ratio.value, ratio.low, ratio.high)
        });
        writeln!(
            text,
            "{:>7}: signal to noise {ratio}; {} trials for +-0.2; {}",
            measure.symbol,
            measure.components.trials_for_fifth,
            shares.join(", ")
        )
        .ok();
    }
    if let Some(ranks) = &summary.ranks {
        let tau = ranks.tau.map(|tau| tau.map_or("-".to_owned(), |tau| format!("{tau:.2}")));
        writeln!(
            text,
            "\nmean ranks of {} worlds by score 1 and by score 2; Kendall's tau of D {}, M {}, N {}",
            ranks.worlds, tau[0], tau[1], tau[2]
        )
        .ok();
        for family in &ranks.families {
            let ranks = [family.difficulty, family.mapping, family.navigation];
            let ranks = ranks.map(|[one, two]| format!("{one:5.1} {two:5.1}"));
            writeln!(text, "{:>40}  D {}  M {}  N {}", family.family, ranks[0], ranks[1], ranks[2])
                .ok();
        }
    }
    for group in summary.faults.chunk_by(|a, b| a.kind == b.kind) {
        writeln!(text, "\n{:?}: {} trials", group[0].kind, group.len()).ok();
        for fault in group.iter().take(faults) {
            let record = &fault.record;
            let result = record.scores.map_or_else(
                || format!("no trial: {}", record.failure.as_deref().unwrap_or_default()),
                |scores| {
                    format!(
                        "{} after {:.0} s, C {:.2}, ATE {:.2} m",
                        record.end.map_or("no end", |end| end.text()),
                        scores.time,
                        scores.coverage,
                        scores.trajectory_error
                    )
                },
            );
            writeln!(
                text,
                "  {} seed {}, {}, noise {}: {result}",
                fault.family, record.world_seed, fault.condition, record.noise_seed
            )
            .ok();
        }
    }
    text
}
