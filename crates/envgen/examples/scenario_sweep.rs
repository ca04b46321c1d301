//! Runs the people and doors of random maps for a long time, and states at every step whether anyone is in
//! something:
//!
//! ```sh
//! cargo run --release --example scenario_sweep -- sweep.jsonl 100
//! ```
//!
//! runs 100 maps for an hour each; `scenario_sweep sweep.jsonl 100 7 12` runs those of seeds 7 and 12 alone. Each map is one line of the file, so that a stopped run can be resumed. It
//! ends with exit code 1 if someone overlaps with anything by a centimetre, or stays for over a minute where a path
//! away is free.

#[path = "../tests/common/busy_map.rs"]
mod busy_map;
#[path = "../tests/common/watch.rs"]
mod watch;

use std::fs::OpenOptions;
use std::io::{BufRead, BufReader, Write};
use std::process::ExitCode;

use busy_map::busy_map;
use envgen::Seed;
use envgen::scenario::{ScenarioState, TICKS_PER_SECOND};
use serde_json::{Value, json};
use watch::Watch;

/// Seconds that each map runs.
const TIME: u64 = 3600;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(path), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("usage: scenario_sweep FILE.jsonl MAPS [SEED]...".into());
    };
    let count: u64 = count.parse()?;
    let own: Vec<u64> = arguments.map(|seed| seed.parse()).collect::<Result<_, _>>()?;
    let count = if own.is_empty() { count } else { own.len() as u64 };
    let mut file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
    let mut lines: Vec<Value> = Vec::new();
    for line in BufReader::new(&file).lines() {
        lines.push(serde_json::from_str(&line?)?);
    }
    let mut out = std::io::stdout().lock();
    for index in lines.len() as u64..count {
        let line = run(Seed(own.get(index as usize).copied().unwrap_or(index)))?;
        writeln!(file, "{line}")?;
        writeln!(out, "{}/{count}: {line}", index + 1)?;
        lines.push(line);
    }
    let values =
        |name: &str| -> Vec<f64> { lines.iter().filter_map(|line| line[name].as_f64()).collect() };
    let sum = |name: &str| values(name).iter().sum::<f64>();
    let most = |name: &str| values(name).into_iter().fold(0.0, f64::max);
    let over = |name: &str| values(name).iter().filter(|seconds| **seconds > 60.0).count();
    writeln!(
        out,
        "{} maps, {:.0} h of people: {:.1} % of walks are waits, longest {:.0} s, over a minute in {} maps; with \
         a free path {:.0} s, over a minute in {} maps; without a goal {:.0} s, longest {:.0} s; greatest overlap \
         {:.6} m",
        lines.len(),
        sum("person_hours"),
        100.0 * sum("waited_s") / sum("walked_s").max(1.0),
        most("longest_s"),
        over("longest_s"),
        most("stuck_s"),
        over("stuck_s"),
        sum("no_goal_s"),
        most("longest_no_goal_s"),
        most("overlap_m"),
    )?;
    Ok(ExitCode::from(u8::from(most("overlap_m") > 0.01 || over("stuck_s") > 0)))
}

/// Runs a map.
fn run(seed: Seed) -> Result<Value, Box<dyn std::error::Error>> {
    let (world, scenario) = busy_map(seed)?;
    let people = scenario.people.len() as f64;
    let mut state = ScenarioState::new(&world, &scenario)?;
    let mut watch = Watch::default();
    for _ in 0..TIME * TICKS_PER_SECOND {
        state.step(1.0 / TICKS_PER_SECOND as f64, &[])?;
        watch.look(&state, &[]);
    }
    Ok(json!({
        "seed": seed.0,
        "person_hours": people * TIME as f64 / 3600.0,
        "walked_s": watch.walked,
        "waited_s": watch.waited,
        "longest_s": watch.longest,
        "stuck_s": watch.stuck,
        "no_goal_s": watch.without_goal.0,
        "longest_no_goal_s": watch.without_goal.1,
        "overlap_m": watch.overlap.0,
        "with": watch.overlap.1,
    }))
}
