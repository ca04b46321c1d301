//! The proof that maps are as difficult as requested. Maps are generated for requests that are spread
//! over the range of difficulties of their size. They are measured by trials under the conditions of
//! the calibration and under others.
//!
//! ```text
//! cargo run --release --example difficulty_proof -- --quick
//! cargo run --release --example difficulty_proof
//! ```
//!
//! Every finished trial is written to disk at once, so that the same command continues an interrupted
//! run. The output folder gets `report.html`, its figures as `requested_8.svg` and so on, and
//! `summary.json`. They are the same to the last byte, whatever the number of threads, and however
//! often the run was interrupted.
//!
//! # Many machines
//!
//! `--shard I/N` runs a share of the maps, and `--merge` merges the shares into the same report. All
//! jobs, and the merge, have the same other arguments:
//!
//! ```text
//! difficulty_proof --maps 32 --threads 1 --shard 1/2 --out out/part1
//! difficulty_proof --maps 32 --threads 1 --shard 2/2 --out out/part2
//! difficulty_proof --maps 32 --merge out/part1 out/part2 --out out/all
//! ```

#[path = "../crates/mapping_trial/src/bin/envgen-trials/progress.rs"]
mod progress;
#[path = "../crates/mapping_trial/src/bin/envgen-trials/spinner.rs"]
mod spinner;
#[path = "../crates/mapping_trial/src/bin/envgen-trials/stdout.rs"]
mod stdout;

use std::error::Error;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use envgen::Seed;
use envgen::whole_file;
use mapping_trial::difficulty::proof::{
    Analysis, Dial, Part, ProofDesign, analyse, figure, merge, page, run,
};
use mapping_trial::difficulty::reference_scale;
use mapping_trial::experiment::Shard;
use mapping_trial::names::Named;

use crate::progress::Progress;
use crate::spinner::spinner;

/// Are maps as difficult as requested? Maps of fixed sizes are generated for requests over all that their size
/// reaches, and measured by trials.
///
/// The same command continues an interrupted run.
#[derive(Parser)]
struct Arguments {
    /// A short form: maps of 8 x 8 cells, one trial per map and condition, no verified maps.
    #[arg(long)]
    quick: bool,

    /// Sides of the maps in cells of 3 m [default: 8,10,16, with --quick 8].
    #[arg(long, value_delimiter = ',')]
    footprints: Option<Vec<u32>>,

    /// Calibrated maps per footprint [default: 120, with --quick 16].
    #[arg(long)]
    maps: Option<u32>,

    /// Verified maps per footprint [default: 40, with --quick 0].
    #[arg(long)]
    verified: Option<u32>,

    /// What is requested and measured: difficulty, or that of mapping or navigation alone.
    #[arg(long, default_value = "difficulty", value_parser = Dial::named)]
    dial: Dial,

    /// Maps per footprint by the rules of the thesis, which have a difficulty alone [default: 40, with --quick 8,
    /// with another --dial 0].
    #[arg(long)]
    thesis: Option<u32>,

    /// Maps per footprint that link other conditions to the reference panel [default: 20, with --quick 8].
    #[arg(long)]
    link: Option<u32>,

    /// Trials per map and condition, at least [default: 3, with --quick 1].
    #[arg(long)]
    seeds: Option<u32>,

    /// Trials per map and panel, at least: panels of few conditions have more trials of each [default: 12, with
    /// --quick 1].
    #[arg(long)]
    panel_trials: Option<u32>,

    /// A held-out panel to compare with the reference, by its name in the report; repeat for more [default: all].
    #[arg(long, value_name = "NAME")]
    held_out: Vec<String>,

    /// The seed of all maps and noise.
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<Seed>,

    /// Threads; 0 for one per core.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1024))]
    threads: u16,

    /// Run only a share of the maps, such as 2/8.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,

    /// Join the folders of all shares, which were run with the same other options, instead of running trials.
    #[arg(long, value_name = "FOLDER", num_args = 1.., conflicts_with = "shard")]
    merge: Vec<PathBuf>,

    /// The folder to write into.
    #[arg(long, default_value = "out/proof", value_name = "FOLDER")]
    out: PathBuf,
}

impl Arguments {
    fn design(&self) -> Result<ProofDesign, Box<dyn Error>> {
        let usual = if self.quick { ProofDesign::quick() } else { ProofDesign::default() };
        let design = ProofDesign {
            footprints: self.footprints.clone().unwrap_or(usual.footprints),
            maps: self.maps.unwrap_or(usual.maps),
            verified: self.verified.unwrap_or(usual.verified),
            thesis: self.thesis.unwrap_or(if self.dial == Dial::Difficulty {
                usual.thesis
            } else {
                0
            }),
            dial: self.dial,
            link: self.link.unwrap_or(usual.link),
            noise_seeds: self.seeds.unwrap_or(usual.noise_seeds),
            panel_trials: self.panel_trials.unwrap_or(usual.panel_trials),
            held_out: self.held_out.clone(),
            seed: self.seed.unwrap_or(usual.seed),
        };
        design.validate()?;
        Ok(design)
    }
}

#[expect(clippy::print_stderr, reason = "errors go to stderr")]
fn main() -> ExitCode {
    match prove(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn prove(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let design = arguments.design()?;
    let (threads, shard) = (usize::from(arguments.threads), arguments.shard);
    let bar = Progress::new();
    let watch = |stage: &str, done: u64, all: u64| {
        bar.set(stage, done, all);
        ControlFlow::Continue(())
    };
    let mut results = Vec::new();
    for part in [Part::Link, Part::Calibrated, Part::Thesis, Part::Verified] {
        if !arguments.merge.is_empty() {
            merge(&design, part, &arguments.out, &arguments.merge)?;
        }
        if let Some(found) = run(&design, part, &arguments.out, shard, threads, &watch)? {
            results.push((part, found));
        }
    }
    bar.finish();
    if shard != Shard::WHOLE {
        let finished = format!("share {shard} is finished: {}\n", arguments.out.display());
        return Ok(stdout::print(&finished)?);
    }
    let analysing = spinner("analysing");
    let scale = reference_scale();
    let analysis = analyse(&design, scale, &results);
    let report = page(&analysis, scale, &results)?;
    let summary = serde_json::to_vec_pretty(&analysis)?;
    let mut files =
        vec![("report.html".to_owned(), report.into_bytes()), ("summary.json".to_owned(), summary)];
    for &footprint in &design.footprints {
        let svg = figure(design.dial, footprint, scale, &results)?;
        files.push((format!("requested_{footprint}.svg"), svg.into_bytes()));
    }
    for (name, bytes) in files {
        let path = arguments.out.join(name);
        whole_file::write(&path, &bytes)
            .map_err(|error| format!("{}: {}", path.display(), error.error))?;
    }
    analysing.finish_and_clear();
    Ok(stdout::print(&tables(&analysis))?)
}

/// The table of an analysis, and what else is in it.
fn tables(analysis: &Analysis) -> String {
    let mut text = String::new();
    writeln!(
        text,
        "{:>10} cells {:>26} maps    rho   tau  error   near | linked: slope  intercept  error   near",
        "", "panel"
    )
    .ok();
    for row in &analysis.rows {
        let number = |interval: Option<mapping_trial::experiment::stats::Interval>| {
            interval.map_or_else(|| "-".to_owned(), |interval| format!("{:.2}", interval.value))
        };
        let part = format!("{:?}", row.part).to_lowercase();
        writeln!(
            text,
            "{part:>10} {:5} {:>26} {:4} {:>6} {:>5} {:>6} {:>6} | {:>13} {:>10} {:>6} {:>6}",
            row.footprint,
            row.panel,
            row.raw.maps,
            number(row.raw.rho),
            number(row.raw.tau),
            number(row.raw.error),
            number(row.raw.near),
            number(row.linked.slope),
            number(row.linked.intercept),
            number(row.linked.error),
            number(row.linked.near)
        )
        .ok();
    }
    for one in &analysis.dropped {
        let part = format!("{:?}", one.part).to_lowercase();
        writeln!(
            text,
            "{} of the {} maps of {} cells of the part {part} are left out: a panel cannot run in them",
            one.dropped, one.maps, one.footprint
        )
        .ok();
    }
    for level in &analysis.levels {
        writeln!(
            text,
            "{} cells, requests of {}: measured {:.2} +- {:.2} over {} maps",
            level.footprint, level.level, level.mean, level.half_interval, level.maps
        )
        .ok();
    }
    for single in &analysis.singles {
        writeln!(
            text,
            "{} cells: the {} {} explains {:.2} of the order, metres of wall {:.2}",
            single.footprint, single.of, single.name, single.explained, single.wall_length
        )
        .ok();
    }
    text
}
