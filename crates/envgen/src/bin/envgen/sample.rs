//! `envgen sample`.

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::{Seed, SpecError, WorldBlueprint, WorldKind, WorldMetrics};
use serde::Serialize;
use serde_json::Value;

use crate::failure::{Failure, print_line};
use crate::platform::PlatformOptions;
use crate::progress::bar;
use crate::source::{Source, note};

/// At most this many seeds without a blueprint, and without a difficulty vector, are listed on stderr; the
/// others are counted.
const NAMED_FAILURES: u64 = 10;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Number of blueprints; their seeds are consecutive, starting at --seed.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true)]
    count: u64,

    /// What to compute for each seed.
    #[arg(long, value_enum, default_value_t = Measures::Blueprint, value_name = "MEASURES")]
    metrics: Measures,

    #[command(flatten)]
    platform: PlatformOptions,
}

/// What is measured of each seed.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Measures {
    /// The blueprint alone.
    Blueprint,
    /// The blueprint, and the difficulty vector of its world, or null if the robot does not fit at the start or
    /// anywhere.
    Difficulty,
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
    /// Where it is requested; null where the robot does not fit at the start, or anywhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    difficulty: Option<Option<DifficultyVector>>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let (source, count) = (&arguments.source, arguments.count);
    let spec = source.spec()?;
    let platform = arguments.platform.read()?;
    if arguments.platform.is_given() && arguments.metrics != Measures::Difficulty {
        let text = "applies to `--metrics difficulty` only".to_owned();
        return Err(Failure::Usage(text).about("--platform"));
    }
    let first = source.seed;
    if count > 0 && first.checked_offset(count - 1).is_none() {
        let most = u64::MAX - first.0 + 1;
        let text = format!("only {most} seeds are left from seed {first} on");
        return Err(Failure::Usage(text).about(format!("--count {count}")));
    }
    let settings = spec.settings_json();
    let bar = bar(count);
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let (mut failures, mut unmeasured, mut missed) = (0_u64, 0_u64, 0_u64);
    for n in 0..count {
        let seed = first.offset(n);
        match spec.generate(seed) {
            Ok(blueprint) => {
                let metrics = &blueprint.metrics();
                let kind = spec.kind();
                if let WorldMetrics::Landscape(landscape) = metrics {
                    missed += u64::from(landscape.total_edge_error.is_some_and(|error| error != 0));
                }
                let difficulty = match arguments.metrics {
                    Measures::Blueprint => None,
                    Measures::Difficulty => {
                        let measured = measure(&blueprint, &platform);
                        if let Err(text) = &measured {
                            unmeasured += 1;
                            if unmeasured <= NAMED_FAILURES {
                                bar.suspend(|| print_line(&format!("seed {seed}: {text}")));
                            }
                        }
                        Some(measured.ok())
                    }
                };
                let blueprint = &blueprint;
                let line = Line { kind, seed, spec: &settings, blueprint, metrics, difficulty };
                serde_json::to_writer(&mut out, &line)?;
                out.write_all(b"\n")?;
            }
            // Some specs have no blueprint for some seeds: the other seeds are still sampled.
            Err(error) => {
                if let Failure::Usage(_) = Failure::from(error.clone()) {
                    return Err(source.ungenerated(spec.kind(), error));
                }
                failures += 1;
                if failures <= NAMED_FAILURES {
                    bar.suspend(|| print_line(&format!("seed {seed}: {error}")));
                }
            }
        }
        bar.inc(1);
    }
    out.flush()?;
    bar.finish_and_clear();
    if unmeasured > NAMED_FAILURES {
        print_line(&format!("{unmeasured} of {count} seeds have no difficulty"));
    }
    if missed > 0 {
        note(&format!(
            "{missed} of {count} landscapes have the nearest total_edge that was found, not the given one"
        ));
    }
    if failures > 0 {
        let text = format!("{failures} of {count} seeds have no {}", spec.kind());
        return Err(source.name(Failure::Failed(text)));
    }
    Ok(ExitCode::SUCCESS)
}

/// The difficulty vector of a blueprint's world, or why it has none.
fn measure(blueprint: &WorldBlueprint, platform: &Platform) -> Result<DifficultyVector, String> {
    let vector = DifficultyVector::of(&blueprint.to_world(), platform);
    vector.map_err(|error| format!("no difficulty: {error}"))
}
