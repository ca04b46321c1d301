//! `envgen sample`.

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::{Kind, Seed, WorldBlueprint, WorldMetrics};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::progress::bar;
use crate::source::Source;

/// So many seeds without a blueprint are named on stderr; the others are counted.
const NAMED_FAILURES: u64 = 10;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// How many blueprints; their seeds are consecutive from --seed on.
    #[arg(long, value_name = "N")]
    count: u64,
}

/// One line of the output.
#[derive(Serialize)]
struct Line<'a> {
    kind: Kind,
    seed: Seed,
    spec: &'a Value,
    blueprint: &'a WorldBlueprint,
    metrics: &'a WorldMetrics,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let spec = arguments.source.spec()?;
    let settings = spec.settings_json();
    let bar = bar(arguments.count);
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let mut failures = 0_u64;
    for n in 0..arguments.count {
        let seed = arguments.source.seed.offset(n);
        match spec.generate(seed) {
            Ok(blueprint) => {
                let metrics = &blueprint.metrics();
                let kind = spec.kind();
                let line = Line { kind, seed, spec: &settings, blueprint: &blueprint, metrics };
                serde_json::to_writer(&mut out, &line)?;
                out.write_all(b"\n")?;
            }
            // Some laws have no blueprint for some seeds: the others are still asked for.
            Err(error) => {
                if let Failure::Usage(text) = Failure::from(error.clone()) {
                    return Err(Failure::Usage(text));
                }
                failures += 1;
                if failures <= NAMED_FAILURES {
                    bar.suspend(|| say(&format!("seed {seed}: {error}")));
                }
            }
        }
        bar.inc(1);
    }
    out.flush()?;
    bar.finish_and_clear();
    if failures > 0 {
        let text = format!("{failures} of {} seeds have no {}", arguments.count, spec.kind());
        return Err(Failure::Failed(text));
    }
    Ok(ExitCode::SUCCESS)
}

fn say(text: &str) {
    #[expect(clippy::print_stderr, reason = "where the command says what is wrong")]
    {
        eprintln!("{text}");
    }
}
