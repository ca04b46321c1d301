//! Draws random specs over all that the settings allow, generates their worlds, and verifies that
//! every promise holds and is decided:
//!
//! ```sh
//! cargo run --release --example check_sweep -- sweep.jsonl 10000
//! cargo run --release --example check_sweep -- large.jsonl 500 100000
//! ```
//!
//! The last number is the most that a world may cost to make and check, in trees, segments, cells or points, 3000
//! by default. A file is continued with the same number.
//!
//! Each spec is one line of the file, so that a stopped run can be resumed. It ends
//! with exit code 1 if a generator panicked, a world broke an invariant, a promise was broken, or one
//! about a disc of at least a centimetre is undecided.

#[path = "../tests/common/random_spec.rs"]
mod random_spec;

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::{BufRead, BufReader, IsTerminal, Write};
use std::panic::catch_unwind;
use std::process::ExitCode;

use envgen::certificate::{Claim, Verdict, verify};
use envgen::{Seed, WorldKind, WorldSpec};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(path), Some(count)) = (arguments.next(), arguments.next()) else {
        return Err("usage: check_sweep FILE.jsonl COUNT [COST]".into());
    };
    let most = arguments.next().map(|most| most.parse()).transpose()?;
    let most = most.unwrap_or(random_spec::MAX_COST);
    let count: u64 = count.parse()?;
    let mut file = OpenOptions::new().read(true).append(true).create(true).open(path)?;
    let mut totals = BTreeMap::new();
    let mut done = 0;
    for line in BufReader::new(&file).lines() {
        add(&mut totals, &serde_json::from_str(&line?)?);
        done += 1;
    }
    let bar = bar(count, done);
    for index in done..count {
        bar.set_position(index);
        let kind = WorldKind::ALL[(index % WorldKind::ALL.len() as u64) as usize];
        let spec = random_spec::random_spec(kind, index, most);
        let outcome = catch_unwind(|| outcome(&spec, Seed(index)))
            .unwrap_or_else(|_| vec!["panic".to_owned()]);
        let is_sound = outcome.iter().all(|outcome| !is_failure(outcome));
        let spec = if is_sound { Value::Null } else { spec.settings_json() };
        let line = json!({ "index": index, "kind": kind.name(), "outcome": outcome, "spec": spec });
        writeln!(file, "{line}")?;
        add(&mut totals, &line);
    }
    bar.finish_and_clear();
    let mut out = std::io::stdout().lock();
    let mut failed = false;
    for ((kind, outcome), count) in &totals {
        writeln!(out, "{count:8} {kind}: {outcome}")?;
        failed |= is_failure(outcome);
    }
    Ok(ExitCode::from(u8::from(failed)))
}

/// A bar of specs on stderr, of which some were done before; nothing if that is not a terminal.
fn bar(count: u64, done: u64) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(count);
    bar.set_position(done);
    bar.reset_eta();
    match ProgressStyle::with_template("{bar:40} {pos}/{len} specs, {per_sec}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The result of a spec: one entry per promise.
fn outcome(spec: &WorldSpec, seed: Seed) -> Vec<String> {
    let blueprint = match spec.generate(seed) {
        Ok(blueprint) => blueprint,
        Err(_) => return vec!["no world of this seed".to_owned()],
    };
    let world = blueprint.to_world();
    if let Err(violation) = world.check() {
        return vec![format!("violation: {violation}")];
    }
    let mut outcome: Vec<_> = verify(&world)
        .into_iter()
        .map(|(claim, verdict)| match (verdict, radius(&claim)) {
            (Verdict::Undecided(doubt), Some(radius)) if radius < 0.01 => {
                format!("undecided under 1 cm: {doubt}")
            }
            (Verdict::Undecided(doubt), _) => format!("undecided: {doubt}"),
            (verdict, _) => format!("{} {}", name(&claim), verdict.name()),
        })
        .collect();
    if outcome.is_empty() {
        outcome.push("nothing promised".to_owned());
    }
    outcome
}

fn is_failure(outcome: &str) -> bool {
    ["panic", "violation: ", "undecided: "].iter().any(|start| outcome.starts_with(start))
        || outcome.ends_with(" broken")
}

fn add(totals: &mut BTreeMap<(String, String), u64>, line: &Value) {
    let kind = line["kind"].as_str().unwrap_or_default();
    for outcome in line["outcome"].as_array().into_iter().flatten() {
        let outcome = outcome.as_str().unwrap_or_default();
        *totals.entry((kind.to_owned(), outcome.to_owned())).or_insert(0) += 1;
    }
}

fn name(claim: &Claim) -> &'static str {
    match claim {
        Claim::Connected { .. } => "connected",
        Claim::CrossesWestEast { .. } => "crosses west to east",
        Claim::EveryPlaceReachable { .. } => "every place reachable",
        Claim::TreeDistance { .. } => "tree distance",
        Claim::BendRadius { .. } => "bend radius",
        Claim::Headroom { .. } => "headroom",
        Claim::AddedDoorway { .. } => "added doorway",
        _ => "other",
    }
}

fn radius(claim: &Claim) -> Option<f64> {
    match *claim {
        Claim::Connected { radius }
        | Claim::CrossesWestEast { radius, .. }
        | Claim::EveryPlaceReachable { radius } => Some(radius),
        _ => None,
    }
}
