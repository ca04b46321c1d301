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
    for n in 0..arguments.count {
        let seed = arguments.source.seed.offset(n);
        let blueprint = spec.generate(seed).map_err(|error| match Failure::from(error) {
            Failure::Failed(text) => Failure::Failed(format!("seed {seed}: {text}")),
            other => other,
        });
        let blueprint = match blueprint {
            Ok(blueprint) => blueprint,
            Err(failure) => {
                // The lines so far are whole, and stay.
                out.flush()?;
                return Err(failure);
            }
        };
        let metrics = &blueprint.metrics();
        let line =
            Line { kind: spec.kind(), seed, spec: &settings, blueprint: &blueprint, metrics };
        serde_json::to_writer(&mut out, &line)?;
        out.write_all(b"\n")?;
        bar.inc(1);
    }
    out.flush()?;
    bar.finish_and_clear();
    Ok(ExitCode::SUCCESS)
}
