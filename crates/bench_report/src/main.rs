//! Runs all benchmarks of the workspace one after the other, and writes a page of their results.
//!
//! ```text
//! cargo run --release -p bench_report
//! cargo run --release -p bench_report -- --resume
//! cargo run --release -p bench_report -- --only forest --only score
//! ```
//!
//! Each result is a ratio to a bound or a peer that was measured in the same run: it means the same on any machine.
//! What was measured is kept in `target/bench_report`, so that `--resume` continues a run that was stopped, and single
//! benchmarks are renewed with `--only`.

mod benches;
mod machine;
mod page;
mod saved;

use std::error::Error;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use bench_ratio::seconds;
use benches::{Bench, Workspace, build};
use clap::Parser;
use envgen::whole_file;
use indicatif::{ProgressBar, ProgressStyle};
use machine::Machine;
use page::Section;
use saved::{Folder, Saved};

/// Runs all benchmarks of the workspace and writes docs/benchmarks.md.
#[derive(Parser)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
struct Arguments {
    /// Runs only benchmarks that are called so, such as forest, mapping_trial/score, or envgen/ for all of a crate, and
    /// takes the results of the others from their last run on this machine; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

    /// Runs only benchmarks that have not run on this machine.
    #[arg(long)]
    resume: bool,

    /// Lists the benchmarks and runs none.
    #[arg(long)]
    list: bool,

    /// The file to write.
    #[arg(long, value_name = "FILE", default_value = "docs/benchmarks.md")]
    out: PathBuf,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
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

#[expect(clippy::print_stdout, reason = "what the program is for")]
fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let workspace = Workspace::here()?;
    let all = &workspace.benches;
    let wanted = |bench: &&Bench| {
        arguments.only.is_empty() || arguments.only.iter().any(|name| bench.is_called(name))
    };
    let mut benches: Vec<&Bench> = all.iter().filter(wanted).collect();
    if benches.is_empty() {
        let names: Vec<String> = all.iter().map(Bench::name).collect();
        return Err(
            format!("--only: no benchmark has that name, expected {}", names.join(", ")).into()
        );
    }
    if arguments.list {
        benches.iter().for_each(|bench| println!("{}", bench.name()));
        return Ok(());
    }
    let folder = Folder::within(&workspace.target)?;
    let machine = Machine::here();
    if arguments.resume {
        benches.retain(|bench| folder.read(&bench.name(), &machine).is_none());
    }
    if !benches.is_empty() {
        measure(&benches, &folder)?;
    }
    let mut sections = Vec::new();
    for bench in all {
        let name = bench.name();
        if let Some(saved) = folder.read(&name, &machine) {
            sections.push(Section::new(name, bench.summary()?, saved));
        }
    }
    whole_file::write(&arguments.out, page::page(&machine, &sections, all.len()).as_bytes())?;
    let (met, ratios) = page::met(&sections);
    println!("{met} of {ratios} bounds are met; wrote {}", arguments.out.display());
    Ok(())
}

/// Builds and runs benchmarks, and keeps what each printed as soon as it ends. Those that fail are an error after all
/// have run.
fn measure(benches: &[&Bench], folder: &Folder) -> Result<(), Box<dyn Error>> {
    let programs = build(benches)?;
    let bar = progress(benches.len() as u64);
    let mut failures = Vec::new();
    for bench in benches {
        bar.set_message(bench.name());
        let machine = Machine::here();
        let mut printed = Ok(String::new());
        let seconds = seconds(|| printed = bench.run(&programs));
        match printed {
            Ok(printed) => folder.write(&bench.name(), &Saved { machine, seconds, printed })?,
            Err(error) => failures.push(error.to_string()),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n").into()) }
}

/// A bar of benchmarks on stderr; nothing if that is not a terminal.
fn progress(benches: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(benches);
    bar.enable_steady_tick(Duration::from_millis(500));
    let template = "{bar:30} {pos}/{len} benchmarks, {elapsed}, {eta} left: {msg}";
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
