//! Runs the proof in its folder.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use envgen::Seed;
use envgen::indoor::IndoorSpec;
use serde::{Deserialize, Serialize};

use super::design::{Part, ProofDesign, ProofMap, panel_of_condition};
use crate::difficulty::measure::scores;
use crate::difficulty::{Panel, reference_scale, verified};
use crate::experiment::lines::Lines;
use crate::experiment::survey::{SurveyFolder, SurveyProgress};
use crate::experiment::{ExperimentError, Shard, write};

/// A map of the proof with what each panel measured.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofResult {
    /// The map.
    pub map: ProofMap,
    /// The mean score D of each panel, the reference first.
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

/// Runs what is left of a part and returns its results; `None` where `watch` stopped it.
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
    let survey = design.survey(&maps);
    let mut folder = SurveyFolder::open(&folder.join(name), &survey, Shard::WHOLE)?;
    let is_whole = folder
        .run(threads, &|progress: SurveyProgress<'_>| watch(name, progress.done, progress.all))?;
    if !is_whole {
        return Ok(None);
    }
    let panel_of = panel_of_condition();
    let panels = panel_of.last().map_or(0, |last| last + 1);
    let mut found: BTreeMap<u32, Vec<Vec<f64>>> = BTreeMap::new();
    for record in folder.records() {
        let own = found.entry(record.map).or_insert_with(|| vec![Vec::new(); panels]);
        let difficulty = record.scores.as_ref().map(|one| scores(one).difficulty);
        own[panel_of[record.condition as usize]].extend(difficulty);
    }
    let result = |(map, scores): (ProofMap, Vec<Vec<f64>>)| {
        let means = scores.iter().map(|all| all.iter().sum::<f64>() / all.len() as f64);
        ProofResult { map, scores: means.collect() }
    };
    // A world in which a robot cannot drive has no place in the comparison of panels.
    let pairs = maps.into_iter().zip(found.into_values());
    let whole = pairs.filter(|(_, scores)| scores.iter().all(|all| !all.is_empty()));
    Ok(Some(whole.map(result).collect()))
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
            map.spec.clone_from(known);
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
