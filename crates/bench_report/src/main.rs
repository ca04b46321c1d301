//! Runs all benchmarks of the workspace one after the other, and writes a page of their results.
//!
//! ```text
//! cargo run --release -p bench_report
//! cargo run --release -p bench_report -- --only forest --only score --out target/benchmarks.md
//! ```
//!
//! Each result is a ratio to a bound or a peer that was measured in the same run: it means the same on any machine.

mod benches;
mod machine;
mod page;

use std::error::Error;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use benches::Bench;
use clap::Parser;
use envgen::whole_file;
use indicatif::{ProgressBar, ProgressStyle};
use machine::Machine;

/// Runs all benchmarks of the workspace and writes docs/benchmarks.md.
#[derive(Parser)]
#[expect(clippy::doc_markdown, reason = "help texts are not Markdown")]
struct Arguments {
    /// Runs only benchmarks whose name has this in it, such as forest or mapping_trial/score; may be given several
    /// times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

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
    let all = benches::all()?;
    let wanted = |bench: &&Bench| {
        let name = bench.name();
        arguments.only.is_empty() || arguments.only.iter().any(|part| name.contains(part))
    };
    let benches: Vec<&Bench> = all.iter().filter(wanted).collect();
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
    let machine = Machine::here();
    let bar = progress(benches.len() as u64);
    let mut results = Vec::new();
    for bench in &benches {
        bar.set_message(format!("building {}", bench.name()));
        bench.build()?;
        bar.set_message(bench.name());
        results.push(bench.run()?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let page = page::page(&machine, &results, all.len());
    whole_file::write(&arguments.out, page.as_bytes())?;
    let (met, ratios) = page::met(&results);
    println!("{met} of {ratios} bounds are met; wrote {}", arguments.out.display());
    Ok(())
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
