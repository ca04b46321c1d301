//! Runs the proof in its folder.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use envgen::Seed;
use envgen::calibration::Dials;
use envgen::indoor::IndoorSpec;
use serde::{Deserialize, Serialize};

use super::design::{Part, ProofDesign, ProofMap};
use super::dial::Dial;
use crate::difficulty::measure::{mean, scores};
use crate::difficulty::{Panel, reference_scale, verified};
use crate::experiment::lines::Lines;
use crate::experiment::survey::{Survey, SurveyFolder, SurveyProgress};
use crate::experiment::{ExperimentError, Shard, write};

/// A map of the proof with what each panel measured.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofResult {
    /// The map.
    pub map: ProofMap,
    /// The mean score of each panel by the design's dial, the reference first.
    pub scores: Vec<f64>,
}

/// A map that won its race, as a line of a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Winner {
    seed: Seed,
    spec: IndoorSpec,
}

/// Called with the name of a stage, the number of finished steps of it and of all.
pub type Watch<'a> = &'a (dyn Fn(&str, u64, u64) -> ControlFlow<()> + Sync);

/// Runs what is left of a part and returns the results of all maps in which trials of every panel can run; `None`
/// where `watch` stopped it.
///
/// # Errors
/// A file cannot be written, holds something else, or its trials now give other results.
pub fn run(
    design: &ProofDesign,
    part: Part,
    folder: &Path,
    threads: usize,
    watch: Watch<'_>,
) -> Result<Option<Vec<ProofResult>>, ExperimentError> {
    let mut maps = design.maps(part);
    if maps.is_empty() {
        return Ok(Some(Vec::new()));
    }
    if part == Part::Verified && !race(&mut maps, &folder.join("race"), watch)? {
        return Ok(None);
    }
    let name = match part {
        Part::Calibrated => "calibrated",
        Part::Verified => "verified",
        Part::Thesis => "thesis",
        Part::Link => "link",
    };
    let mut scores = vec![Vec::new(); maps.len()];
    for panel in design.panels() {
        let stage = format!("{name}, {}", panel.name);
        let folder = folder.join(name).join(folder_name(&panel.name));
        let survey = design.survey(&maps, panel);
        let Some(found) = run_panel(&survey, design.dial, &folder, threads, &stage, watch)? else {
            return Ok(None);
        };
        for (own, mean) in scores.iter_mut().zip(found) {
            own.push(mean);
        }
    }
    // A world in which a robot cannot drive has no place in the comparison of panels; the analysis counts these.
    let whole = maps.into_iter().zip(scores).filter_map(|(map, scores)| {
        let scores = scores.into_iter().collect::<Option<Vec<f64>>>()?;
        Some(ProofResult { map, scores })
    });
    Ok(Some(whole.collect()))
}

/// The mean score of each map by a dial under a panel, where trials can run; `None` where `watch` stopped it.
fn run_panel(
    survey: &Survey,
    dial: Dial,
    folder: &Path,
    threads: usize,
    stage: &str,
    watch: Watch<'_>,
) -> Result<Option<Vec<Option<f64>>>, ExperimentError> {
    let mut folder = SurveyFolder::open(folder, survey, Shard::WHOLE)?;
    let is_whole = folder
        .run(threads, &|progress: SurveyProgress<'_>| watch(stage, progress.done, progress.all))?;
    if !is_whole {
        return Ok(None);
    }
    let mut found = vec![Vec::new(); survey.families.len()];
    for record in folder.records() {
        found[record.map as usize].extend(record.scores.as_ref().map(scores));
    }
    let of = |all: Vec<Dials<f64>>| (!all.is_empty()).then(|| dial.of(mean(all.into_iter())));
    Ok(Some(found.into_iter().map(of).collect()))
}

/// The name of a panel, as a folder that needs no quotes.
fn folder_name(panel: &str) -> String {
    let words = panel.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<&str>>().join("_").to_lowercase()
}

/// Replaces each map by the winner of its race; false where `watch` stopped it.
fn race(maps: &mut [ProofMap], folder: &Path, watch: Watch<'_>) -> Result<bool, ExperimentError> {
    write::folder(folder)?;
    let (mut lines, text) = Lines::open(folder)?;
    let winners = winners(&text, &lines.path)?;
    let all = maps.len() as u64;
    let panel = Panel::reference();
    for (map, done) in maps.iter_mut().zip(1..) {
        let seed = map.seed;
        if let Some(known) = winners.get(&seed) {
            map.win(known, &lines.path)?;
            continue;
        }
        let found = verified(&map.spec, seed, &panel, reference_scale(), 1, &mut |_| ())
            .map_err(|error| ExperimentError::Report(format!("seed {seed}: {error}")))?;
        map.spec.candidate = found.candidate;
        lines.append(&Winner { seed, spec: map.spec.clone() })?;
        if watch("race", done, all).is_break() {
            return Ok(false);
        }
    }
    Ok(true)
}

impl ProofMap {
    /// Takes the winner of its race, which must be one of its candidates.
    fn win(&mut self, winner: &IndoorSpec, path: &Path) -> Result<(), ExperimentError> {
        let own = IndoorSpec { candidate: winner.candidate, ..self.spec.clone() };
        if own != *winner {
            let reason = format!("the winner of the seed {} is of another request", self.seed);
            return Err(ExperimentError::Content { path: path.to_owned(), reason });
        }
        self.spec = own;
        Ok(())
    }
}

/// The winners that are known, from whole lines.
fn winners(text: &str, path: &Path) -> Result<BTreeMap<Seed, IndoorSpec>, ExperimentError> {
    let winner = |(i, line): (usize, &str)| {
        let content = |error: serde_json::Error| ExperimentError::Content {
            path: path.to_owned(),
            reason: format!("line {}: {error}", i + 1),
        };
        let Winner { seed, spec } = serde_json::from_str(line).map_err(content)?;
        Ok((seed, spec))
    };
    text.lines().enumerate().map(winner).collect()
}
