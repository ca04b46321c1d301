//! `envgen inspect`.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Args;
use envgen::certificate::{Claim, Verdict, verify};
use envgen::difficulty::{DifficultyVector, Platform};
use envgen::geometry::{Pose, Rect};
use envgen::reproduction::{Reproduction, reproduce};
use envgen::{Provenance, World, WorldMetrics};
use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::platform::PlatformOptions;
use crate::source::{WorldFile, note};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    file: WorldFile,

    /// Prints JSON.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    platform: PlatformOptions,
}

/// What a world file holds.
#[derive(Serialize)]
struct Report<'a> {
    provenance: &'a Provenance,
    digest: String,
    /// Whether this crate generates the same world from the same spec and seed.
    reproducible: bool,
    bounds: Rect,
    start: Option<Pose>,
    goal: Option<Pose>,
    parts: Parts,
    certificate: Vec<Checked>,
    /// Absent when the world is no longer the one of its spec and seed.
    metrics: Option<WorldMetrics>,
    /// Absent when the robot does not fit at the start, or anywhere in a world without one.
    difficulty: Option<DifficultyVector>,
}

#[derive(Serialize)]
struct Parts {
    walls: usize,
    trees: usize,
    road_strips: usize,
    rooms: usize,
    doorways: usize,
    obstacles: usize,
    surfaces: usize,
    raster_cells: usize,
}

#[derive(Serialize)]
struct Checked {
    claim: Claim,
    text: String,
    verdict: Verdict,
    /// Why it is undecided.
    #[serde(skip_serializing_if = "Option::is_none")]
    doubt: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, Failure> {
    let platform = arguments.platform.read()?;
    let world = arguments.file.read()?;
    let report = report(&world, &platform);
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &report)?;
        writeln!(out)?;
    } else {
        let tree = serde_json::to_value(&report)?;
        print(&mut out, &tree, 0)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn report<'a>(world: &'a World, platform: &Platform) -> Report<'a> {
    let again = match reproduce(world) {
        Reproduction::Same(blueprint) => Some(blueprint.metrics()),
        _ => None,
    };
    let difficulty = DifficultyVector::of(world, platform);
    if let Err(error) = &difficulty {
        note(&format!("no difficulty: {error}"));
    }
    let checked = |(claim, verdict): (Claim, Verdict)| Checked {
        claim,
        text: claim.to_string(),
        verdict,
        doubt: verdict.doubt().map(|doubt| doubt.to_string()),
    };
    Report {
        provenance: &world.provenance,
        digest: world.digest().to_string(),
        reproducible: again.is_some(),
        bounds: world.bounds,
        start: world.start,
        goal: world.goal,
        parts: Parts {
            walls: world.walls.len(),
            trees: world.trees.len(),
            road_strips: world.road_strips.len(),
            rooms: world.rooms.len(),
            doorways: world.doorways.len(),
            obstacles: world.obstacles.len(),
            surfaces: world.surfaces.len(),
            raster_cells: world.raster.as_ref().map_or(0, |raster| raster.cells.len()),
        },
        certificate: verify(world).into_iter().map(checked).collect(),
        metrics: again,
        difficulty: difficulty.ok(),
    }
}

/// Prints a tree of values, two spaces per level; lists of plain values are on one line.
fn print(out: &mut impl Write, value: &Value, level: usize) -> io::Result<()> {
    let Value::Object(fields) = value else { return writeln!(out, "{}", plain(value)) };
    for (name, value) in fields {
        write!(out, "{:indent$}{name}:", "", indent = 2 * level)?;
        match value {
            Value::Object(fields) if !fields.is_empty() => {
                writeln!(out)?;
                print(out, value, level + 1)?;
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                writeln!(out)?;
                for item in items {
                    writeln!(out, "{:indent$}-", "", indent = 2 * level + 2)?;
                    print(out, item, level + 2)?;
                }
            }
            _ => writeln!(out, " {}", plain(value))?,
        }
    }
    Ok(())
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        other => other.to_string(),
    }
}
