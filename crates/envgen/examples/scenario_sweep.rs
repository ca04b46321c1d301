//! Runs the people and doors of random maps for a long time, and states at every step whether anyone is in
//! something:
//!
//! ```sh
//! cargo run --release --example scenario_sweep -- sweep.jsonl --maps 100
//! ```
//!
//! runs 100 maps for an hour each. Each map is one line of the file, so that a stopped run can be resumed. It ends
//! with exit code 1 if someone overlaps with anything by a centimetre, or stays for over a minute where a path
//! away is free.

#[path = "../tests/common/busy_map.rs"]
mod busy_map;
#[path = "../tests/common/watch.rs"]
mod watch;

use std::fs::OpenOptions;
use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use busy_map::{MOST_PEOPLE, busy_map};
use clap::Parser;
use envgen::Seed;
use envgen::scenario::{ScenarioState, TICKS_PER_SECOND};
use serde_json::{Value, json};
use watch::Watch;

#[derive(Parser)]
#[command(
    about = "Runs people and doors in random maps, and states whether anyone is in something"
)]
struct Arguments {
    /// The file of results, a line per map. A file of the same options is continued.
    file: PathBuf,
    /// Maps to run.
    #[arg(long, default_value_t = 100)]
    maps: u64,
    /// The seed of the first map; the others have those that follow.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Simulated hours per map.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    hours: u64,
    /// The least area per person in square metres, from 9 to 1e6: a map has at least one person.
    #[arg(long, default_value_t = MOST_PEOPLE, value_parser = area)]
    area: f64,
}

fn area(text: &str) -> Result<f64, String> {
    let area: Option<f64> = text.parse().ok();
    area.filter(|area| (9.0..=1e6).contains(area))
        .ok_or_else(|| "a number from 9 to 1e6 is allowed".to_owned())
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let Arguments { file: path, maps, seed, hours, area } = Arguments::parse();
    let mut file = OpenOptions::new().read(true).append(true).create(true).open(&path)?;
    let mut lines: Vec<Value> = Vec::new();
    // What was being written when it was stopped is run again.
    let mut text = String::new();
    file.read_to_string(&mut text)?;
    text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
    file.set_len(text.len() as u64)?;
    for (line, index) in text.lines().zip(0..) {
        let line: Value = serde_json::from_str(line)
            .map_err(|error| format!("{}: line {}: {error}", path.display(), index + 1))?;
        if ["seed", "hours", "area"].map(|name| &line[name])
            != [&json!(seed.wrapping_add(index)), &json!(hours), &json!(area)]
        {
            return Err(
                format!("{}: line {} is of other options", path.display(), index + 1).into()
            );
        }
        lines.push(line);
    }
    let mut out = std::io::stdout().lock();
    for index in lines.len() as u64..maps {
        let line = run(seed.wrapping_add(index), hours, area)?;
        // At once, so that a line is whole or lacks its end.
        file.write_all(format!("{line}\n").as_bytes())?;
        writeln!(out, "{}/{maps}: {line}", index + 1)?;
        lines.push(line);
    }
    let values =
        |name: &str| -> Vec<f64> { lines.iter().filter_map(|line| line[name].as_f64()).collect() };
    let sum = |name: &str| values(name).iter().sum::<f64>();
    let most = |name: &str| values(name).into_iter().fold(0.0, f64::max);
    let over = |name: &str| values(name).iter().filter(|seconds| **seconds > 60.0).count();
    writeln!(
        out,
        "{} maps, {:.0} h, {:.0} h of people: {:.1} % of walks are waits, longest {:.0} s, over a minute in {} \
         maps; with a free path {:.0} s, over a minute in {} maps; without a goal {:.0} s, longest {:.0} s; greatest \
         overlap {:.6} m",
        lines.len(),
        sum("hours"),
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
fn run(seed: u64, hours: u64, area: f64) -> Result<Value, Box<dyn std::error::Error>> {
    let (world, scenario) = busy_map(Seed(seed), area)?;
    let people = scenario.people.len() as f64;
    let mut state = ScenarioState::new(&world, &scenario)?;
    let mut watch = Watch::default();
    for _ in 0..hours * 3600 * TICKS_PER_SECOND {
        state.step(1.0 / TICKS_PER_SECOND as f64, &[])?;
        watch.look(&state, &[]);
    }
    Ok(json!({
        "seed": seed,
        "hours": hours,
        "area": area,
        "person_hours": people * hours as f64,
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
