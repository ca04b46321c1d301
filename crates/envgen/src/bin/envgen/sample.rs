//! `envgen sample`.

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::{Seed, SpecError, WorldBlueprint, WorldKind, WorldMetrics};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::progress::bar;
use crate::source::Source;

/// At most this many seeds without a blueprint are listed on stderr; the others are counted.
const NAMED_FAILURES: u64 = 10;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Number of blueprints; their seeds are consecutive, starting at --seed.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    count: u64,
}

fn count(text: &str) -> Result<u64, SpecError> {
    let allowed = || format!("a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(|_| SpecError::new("count", text, allowed()))
}

/// One line of the output.
#[derive(Serialize)]
struct Line<'a> {
    kind: WorldKind,
    seed: Seed,
    spec: &'a Value,
    blueprint: &'a WorldBlueprint,
    metrics: &'a WorldMetrics,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let (source, count) = (&arguments.source, arguments.count);
    let spec = source.spec()?;
    let first = source.seed;
    if count > 0 && first.checked_offset(count - 1).is_none() {
        let most = u64::MAX - first.0 + 1;
        let text = format!("only {most} seeds are left from seed {first} on");
        return Err(Failure::Usage(text).about(format!("--count {count}")));
    }
    let settings = spec.settings_json();
    let bar = bar(count);
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let mut failures = 0_u64;
    for n in 0..count {
        let seed = first.offset(n);
        match spec.generate(seed) {
            Ok(blueprint) => {
                let metrics = &blueprint.metrics();
                let kind = spec.kind();
                let line = Line { kind, seed, spec: &settings, blueprint: &blueprint, metrics };
                serde_json::to_writer(&mut out, &line)?;
                out.write_all(b"\n")?;
            }
            // Some specs have no blueprint for some seeds: the other seeds are still sampled.
            Err(error) => {
                if let failure @ Failure::Usage(_) = Failure::from(error.clone()) {
                    return Err(source.name(failure));
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
        let text = format!("{failures} of {count} seeds have no {}", spec.kind());
        return Err(source.name(Failure::Failed(text)));
    }
    Ok(ExitCode::SUCCESS)
}

fn say(text: &str) {
    #[expect(clippy::print_stderr, reason = "where the command prints errors")]
    {
        eprintln!("{text}");
    }
}
