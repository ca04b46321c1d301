//! Runs the people and doors of random maps for a long time, and states at every step whether anyone is in
//! something:
//!
//! ```sh
//! cargo run --release --example scenario_sweep -- sweep.jsonl 100
//! ```
//!
//! runs 100 maps for an hour each. Each map is one line of the file, so that a stopped run can be resumed. It
//! ends with exit code 1 if someone overlaps with anything by a centimetre.

#[path = "../tests/common/watch.rs"]
mod watch;

use std::fs::OpenOptions;
use std::io::{BufRead, BufReader, Write};
use std::process::ExitCode;

use envgen::indoor::IndoorSpec;
use envgen::scenario::{
    DoorControl, DoorKinds, Scenario, ScenarioSpec, ScenarioState, TICKS_PER_SECOND,
};
use envgen::{Blueprint, Seed, Spec};
use serde_json::{Value, json};
use watch::Watch;

/// Seconds that each map runs.
const TIME: u64 = 3600;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(path), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("usage: scenario_sweep FILE.jsonl MAPS".into());
    };
    let count: u64 = count.parse()?;
    let mut file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
    let mut lines: Vec<Value> = Vec::new();
    for line in BufReader::new(&file).lines() {
        lines.push(serde_json::from_str(&line?)?);
    }
    let mut out = std::io::stdout().lock();
    for index in lines.len() as u64..count {
        let line = run(Seed(index))?;
        writeln!(file, "{line}")?;
        writeln!(out, "{}/{count}: {line}", index + 1)?;
        lines.push(line);
    }
    let values =
        |name: &str| -> Vec<f64> { lines.iter().filter_map(|line| line[name].as_f64()).collect() };
    let sum = |name: &str| values(name).iter().sum::<f64>();
    let most = |name: &str| values(name).into_iter().fold(0.0, f64::max);
    let stuck = values("longest_s").iter().filter(|longest| **longest > 60.0).count();
    writeln!(
        out,
        "{} maps, {:.0} h of people: {:.1} % of walks are waits, longest {:.0} s, over a minute in {stuck} maps; \
         greatest overlap {:.6} m",
        lines.len(),
        sum("person_hours"),
        100.0 * sum("waited_s") / sum("walked_s").max(1.0),
        most("longest_s"),
        most("overlap_m"),
    )?;
    Ok(ExitCode::from(u8::from(most("overlap_m") > 0.01)))
}

/// A map of a random size with random people and doors.
fn run(seed: Seed) -> Result<Value, Box<dyn std::error::Error>> {
    let mut stream = seed.stream("scenario_sweep", 0);
    let side = 5 + stream.below(12) as u32;
    let world =
        IndoorSpec { width: side, height: side, ..Default::default() }.generate(seed)?.to_world();
    let kinds = [DoorKinds::Mixed, DoorKinds::Hinged, DoorKinds::Double, DoorKinds::Sliding];
    let spec = ScenarioSpec {
        doors: stream.between(0.0, 1.0),
        door_kind: kinds[stream.below(4) as usize],
        door_control: if stream.chance(0.3) { DoorControl::Triggered } else { DoorControl::Timed },
        slam: stream.between(0.0, 1.0),
        // Up to one person on 18 square metres: cells have 9.
        people: 1 + stream.below(u64::from(side * side)) as u32 / 2,
        working: 10.0,
        waiting: 5.0,
        ..Default::default()
    };
    let people = spec.people;
    let mut state = ScenarioState::new(&world, &Scenario::new(&world, &spec, seed)?)?;
    let mut watch = Watch::default();
    for _ in 0..TIME * TICKS_PER_SECOND {
        state.step(1.0 / TICKS_PER_SECOND as f64, &[])?;
        watch.look(&state, &[]);
    }
    Ok(json!({
        "seed": seed.0,
        "side_cells": side,
        "person_hours": f64::from(people) * TIME as f64 / 3600.0,
        "walked_s": watch.walked,
        "waited_s": watch.waited,
        "longest_s": watch.longest,
        "overlap_m": watch.overlap.0,
        "with": watch.overlap.1,
    }))
}
