//! Runs the proof in its folder.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use envgen::Seed;
use envgen::indoor::IndoorSpec;
use serde::{Deserialize, Serialize};
use statrs::statistics::Statistics;

use super::design::{Part, ProofDesign, ProofMap};
use super::dial::Dial;
use crate::difficulty::measure::scores;
use crate::difficulty::{Panel, reference_scale, verified};
use crate::experiment::lines::{self, Lines};
use crate::experiment::survey::{SurveyFolder, SurveyProgress};
use crate::experiment::{ExperimentError, Shard, write};

/// The folder of the winners of races.
const RACE: &str = "race";

/// A map of the proof, with the measurements of each panel.
#[derive(Clone, Debug, PartialEq)]
pub struct ProofResult {
    /// The map.
    pub map: ProofMap,
    /// Mean score by the design's dial for each panel, the reference first.
    pub scores: Vec<f64>,
    /// Variance of each of these means by noise, computed from the variances within conditions; `None`
    /// if a condition has a single trial.
    pub noise: Vec<Option<f64>>,
}

/// A map that won its race, as a line of a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Winner {
    seed: Seed,
    spec: IndoorSpec,
}

/// A function that is called with the name of a stage, the number of its finished steps, and the number
/// of all its steps.
pub type Watch<'a> = &'a (dyn Fn(&str, u64, u64) -> ControlFlow<()> + Sync);

/// Runs the remaining trials of a share of a part, which has maps of every footprint. Returns the
/// results of those maps in which trials of every panel can run; `None` if `watch` stopped it.
///
/// # Errors
///
/// If a file cannot be written, holds something else, or its trials now give other results.
pub fn run(
    design: &ProofDesign,
    part: Part,
    folder: &Path,
    shard: Shard,
    threads: usize,
    watch: Watch<'_>,
) -> Result<Option<Vec<ProofResult>>, ExperimentError> {
    shard.validate()?;
    let mut maps = design.maps(part);
    if maps.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let kinds = design.footprints.len();
    if part == Part::Verified {
        let own = maps.iter_mut().enumerate().filter(|(i, _)| shard.has_of(*i, kinds));
        let own = own.map(|(_, map)| map).collect();
        if !races(own, &folder.join(RACE), threads, watch)? {
            return Ok(None);
        }
    }
    let mut means = vec![Vec::new(); maps.len()];
    for panel in design.panels() {
        let stage = format!("{}, {}", part.name(), panel.name);
        let folder = folder.join(inner_folder(part, &panel));
        let survey = design.survey(&maps, panel);
        let mut folder = SurveyFolder::open_of_kinds(&folder, &survey, shard, kinds)?;
        let watch = |progress: SurveyProgress<'_>| watch(&stage, progress.done, progress.all);
        if !folder.run(threads, &watch)? {
            return Ok(None);
        }
        for (own, mean) in means.iter_mut().zip(map_means(&folder, design.dial)) {
            own.push(mean);
        }
    }
    // A world in which a robot cannot drive is left out of the comparison of panels. The analysis
    // counts these worlds.
    let whole = maps.into_iter().zip(means).filter_map(|(map, means)| {
        let means = means.into_iter().collect::<Option<Vec<Mean>>>()?;
        let (scores, noise) = means.into_iter().map(|mean| (mean.score, mean.noise)).unzip();
        Some(ProofResult { map, scores, noise })
    });
    Ok(Some(whole.collect()))
}

/// Merges the folders of all shares of a part into a folder of its own, as if one run had made it.
///
/// # Errors
///
/// If shares have another design, if results differ or are missing, or if the folder cannot be written
/// or holds something else.
pub fn merge(
    design: &ProofDesign,
    part: Part,
    folder: &Path,
    shares: &[PathBuf],
) -> Result<(), ExperimentError> {
    let mut maps = design.maps(part);
    if maps.is_empty() {
        return Ok(());
    }
    if part == Part::Verified {
        merge_races(&mut maps, &folder.join(RACE), shares)?;
    }
    for panel in design.panels() {
        let inner = inner_folder(part, &panel);
        let shares: Vec<PathBuf> = shares.iter().map(|share| share.join(&inner)).collect();
        SurveyFolder::merge_of(&design.survey(&maps, panel), &folder.join(&inner), &shares)?;
    }
    Ok(())
}

/// The folder of a part's trials under a panel.
fn inner_folder(part: Part, panel: &Panel) -> PathBuf {
    Path::new(part.name()).join(folder_name(&panel.name))
}

/// The measurement of a map by a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mean {
    score: f64,
    /// Variance of the score by noise.
    noise: Option<f64>,
}

impl Mean {
    /// Computes the mean over trials, given with their conditions; `None` without trials.
    fn new(trials: &[(u32, f64)]) -> Option<Self> {
        let mut sorted = trials.to_vec();
        sorted.sort_by_key(|(condition, _)| *condition);
        let conditions: Vec<Vec<f64>> = sorted
            .chunk_by(|a, b| a.0 == b.0)
            .map(|trials| trials.iter().map(|(_, score)| *score).collect())
            .collect();
        let count = conditions.len() as f64;
        let variances = conditions.iter().map(|scores| {
            (scores.len() > 1).then(|| scores.variance() / scores.len() as f64 / (count * count))
        });
        let noise = variances.sum::<Option<f64>>();
        let score = conditions.iter().map(|scores| scores.mean()).mean();
        (!conditions.is_empty()).then_some(Mean { score, noise })
    }
}

/// The mean of each map by a dial under a panel, if trials can run in it.
fn map_means(folder: &SurveyFolder, dial: Dial) -> Vec<Option<Mean>> {
    let mut found = vec![Vec::new(); folder.survey().families.len()];
    for record in folder.records() {
        let score = record.scores.as_ref().map(|all| (record.condition, dial.of(scores(all))));
        found[record.map as usize].extend(score);
    }
    found.iter().map(|trials| Mean::new(trials)).collect()
}

/// Converts the name of a panel to that of a folder, which needs no quotes.
fn folder_name(panel: &str) -> String {
    let words = panel.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<&str>>().join("_").to_lowercase()
}

/// Replaces each map by the winner of its race. Returns false if `watch` stopped it.
fn races(
    maps: Vec<&mut ProofMap>,
    folder: &Path,
    threads: usize,
    watch: Watch<'_>,
) -> Result<bool, ExperimentError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| ExperimentError::Threads(error.to_string()))?;
    write::folder(folder)?;
    let (mut lines, text) = Lines::open(folder)?;
    let winners = winners(&text, &lines.path)?;
    lines.drop_rest(&text)?;
    let all = maps.len() as u64;
    let panel = Panel::reference();
    for (map, done) in maps.into_iter().zip(1..) {
        let seed = map.seed;
        if let Some(known) = winners.get(&seed) {
            map.win(known, &lines.path)?;
            continue;
        }
        let found = pool
            .install(|| verified(&map.spec, seed, &panel, reference_scale(), 1, &mut |_| ()))
            .map_err(|error| ExperimentError::World {
                world: format!("the verified map of seed {seed}"),
                reason: error.to_string(),
            })?;
        map.spec.candidate = found.candidate;
        lines.append(&Winner { seed, spec: map.spec.clone() })?;
        if watch("race", done, all).is_break() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Merges the races of all shares, and replaces each map by its winner.
fn merge_races(
    maps: &mut [ProofMap],
    folder: &Path,
    shares: &[PathBuf],
) -> Result<(), ExperimentError> {
    let mut known = BTreeMap::new();
    for share in shares {
        let (text, path) = lines::read(&share.join(RACE))?;
        for (seed, spec) in winners(&text, &path)? {
            if known.get(&seed).is_some_and(|known| *known != spec) {
                return Err(ExperimentError::Code { path, trial: race_of(seed) });
            }
            known.insert(seed, spec);
        }
    }
    let mut missing = maps.iter().filter(|map| !known.contains_key(&map.seed));
    if let Some(first) = missing.next() {
        let (missing, all) = (1 + missing.count(), maps.len());
        return Err(ExperimentError::Incomplete { missing, all, first: race_of(first.seed) });
    }
    write::folder(folder)?;
    let (mut file, earlier) = Lines::open(folder)?;
    // Races that the shares do not have are not lost.
    for (seed, spec) in winners(&earlier, &file.path)? {
        if known.get(&seed) != Some(&spec) {
            let reason = format!("it has another winner in {}, or another proof", race_of(seed));
            return Err(ExperimentError::Content { path: file.path.clone(), reason });
        }
    }
    let mut text = Vec::new();
    for map in maps {
        if let Some(spec) = known.remove(&map.seed) {
            map.win(&spec, &file.path)?;
            text.extend(lines::line(&Winner { seed: map.seed, spec }, &file.path)?);
        }
    }
    file.replace(&text)
}

/// A race in words.
fn race_of(seed: Seed) -> String {
    format!("the race of the map of seed {seed}")
}

impl ProofMap {
    /// Sets the winner of a map's race, which must be one of its candidates.
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

/// Reads the known winners from complete lines.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn races_of_another_proof_are_not_lost() {
        let design = ProofDesign { footprints: vec![8], verified: 2, ..ProofDesign::quick() };
        let fewer = ProofDesign { verified: 1, ..design.clone() };
        let (own, share) = (tempfile::tempdir().expect("a"), tempfile::tempdir().expect("b"));
        let fill = |folder: &Path, design: &ProofDesign| {
            let (mut file, _) = Lines::open(folder).expect("a file");
            for map in design.maps(Part::Verified) {
                file.append(&Winner { seed: map.seed, spec: map.spec }).expect("a winner");
            }
        };
        let folder = own.path().join(RACE);
        for (path, design) in [(&folder, &design), (&share.path().join(RACE), &fewer)] {
            write::folder(path).expect("a folder");
            fill(path, design);
        }
        let before = lines::read(&folder).expect("races").0;
        let shares = [share.path().to_owned()];
        let merged = |into: &Path| merge_races(&mut fewer.maps(Part::Verified), into, &shares);
        let error = merged(&folder).expect_err("two races for one").to_string();
        assert!(error.contains("another proof"), "{error}");
        assert_eq!(lines::read(&folder).expect("races").0, before);
        merged(&own.path().join("new")).expect("an empty folder");
    }

    #[test]
    fn noise_is_what_trials_of_a_condition_differ_by() {
        // Two trials of each of two conditions: variances of 2 and 8, of two trials, of two conditions.
        let trials = [(0, 1.0), (1, 3.0), (0, 3.0), (1, 7.0)];
        let found = Mean::new(&trials).expect("a mean");
        assert_eq!(found, Mean { score: 3.5, noise: Some((1.0 + 4.0) / 4.0) });
        let single = Mean::new(&trials[..2]).expect("a mean");
        assert_eq!(single, Mean { score: 2.0, noise: None });
        // Conditions count the same, however many trials they have.
        let uneven = Mean::new(&[(0, 1.0), (0, 3.0), (1, 5.0)]).expect("a mean");
        assert_eq!(uneven, Mean { score: 3.5, noise: None });
        assert_eq!(Mean::new(&[]), None);
    }
}
