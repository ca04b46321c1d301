//! The folder of an experiment.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::design::{Design, Shard, TrialId, policy_name};
use super::error::ExperimentError;
use super::head;
use super::lines::{self, Lines, line};
use super::record::Record;
use super::site::Site;
use super::write;

/// Version of the layout of folders. A folder of another version is rejected.
pub const EXPERIMENT_VERSION: u32 = 3;

/// The file that describes what a folder holds.
const HEAD: head::Kind =
    head::Kind { file: head::EXPERIMENT, what: "an experiment", version: EXPERIMENT_VERSION };

/// The content of a folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    version: u32,
    shard: Shard,
    pub(super) design: Design,
}

/// An experiment in its folder, which keeps finished trials, whatever happens to the program.
///
/// ```no_run
/// use std::ops::ControlFlow;
///
/// use mapping_trial::experiment::{Design, Experiment, Shard, report};
///
/// let mut experiment = Experiment::open("out".as_ref(), &Design::quick(), Shard::WHOLE)?;
/// experiment.run(0, &|progress| {
///     println!("{} of {}", progress.done, progress.all);
///     ControlFlow::Continue(())
/// })?;
/// report::write(&experiment, 0)?;
/// # Ok::<(), mapping_trial::experiment::ExperimentError>(())
/// ```
#[derive(Debug)]
pub struct Experiment {
    folder: PathBuf,
    pub(super) head: Head,
    /// The trials of this share, with their indices in the design's order.
    pub(super) trials: Vec<(usize, TrialId)>,
    /// Finished trials, by index.
    pub(super) records: BTreeMap<usize, Record>,
    pub(super) lines: Lines,
}

impl Experiment {
    /// Begins an experiment in a folder, or continues it. An incomplete last line is dropped.
    ///
    /// # Errors
    ///
    /// If the design is not allowed, or if the folder cannot be written, holds another experiment, is
    /// in use, or holds trials that now give other results.
    pub fn open(folder: &Path, design: &Design, shard: Shard) -> Result<Self, ExperimentError> {
        design.validate()?;
        shard.validate()?;
        let head = Head { version: EXPERIMENT_VERSION, shard, design: design.clone() };
        let (lines, text) = head::lock(folder, &HEAD, &head, difference)?;
        let trials = share(&head);
        let records = parse(&text, &head, &lines.path)?;
        let experiment = Experiment { folder: folder.to_owned(), head, trials, records, lines };
        experiment.check_code()?;
        Ok(experiment)
    }

    /// Begins an experiment again: deletes what a folder holds of an earlier one.
    ///
    /// # Errors
    ///
    /// As [`Experiment::open`].
    pub fn fresh(folder: &Path, design: &Design, shard: Shard) -> Result<Self, ExperimentError> {
        design.validate()?;
        shard.validate()?;
        write::folder(folder)?;
        // Results that this program cannot make again are not deleted.
        let content = |reason| ExperimentError::Content { path: folder.to_owned(), reason };
        if folder.join(head::SURVEY).exists() {
            return Err(content(format!("it holds a survey: {}", head::SURVEY)));
        }
        // The file is locked before anything is deleted, since another process may be writing.
        let mut lines = Lines::lock(folder)?;
        if folder.join(HEAD.file).exists() {
            // The report of the earlier experiment would pass for that of this one.
            write::remove_report(folder)?;
            lines.cut(0)?;
        } else if !lines.is_empty() {
            return Err(content(format!("there are trials, but no {}, in it", HEAD.file)));
        }
        let head = Head { version: EXPERIMENT_VERSION, shard, design: design.clone() };
        head::write(&folder.join(HEAD.file), &head)?;
        let (folder, trials) = (folder.to_owned(), share(&head));
        Ok(Experiment { folder, head, trials, records: BTreeMap::new(), lines })
    }

    /// Merges the shares of an experiment into a folder of its own. Shares may overlap.
    ///
    /// # Errors
    ///
    /// If shares have different designs, if trials differ or are missing (nothing is written then), or
    /// if the folder cannot be written or holds another experiment.
    pub fn merge(folder: &Path, parts: &[PathBuf]) -> Result<Self, ExperimentError> {
        let mut whole: Option<Head> = None;
        let mut records: BTreeMap<usize, Record> = BTreeMap::new();
        for part in parts {
            let path = part.join(HEAD.file);
            let missing = || ExperimentError::Content {
                path: path.clone(),
                reason: "this file does not exist: the folder holds no share".to_owned(),
            };
            let head = read_head(&path)?.ok_or_else(missing)?;
            // This is checked before the trials are listed, since they may need more memory than there
            // is.
            head.design.validate().and_then(|()| head.shard.validate()).map_err(|error| {
                ExperimentError::Content { path: path.clone(), reason: error.to_string() }
            })?;
            let joined = Head { shard: Shard::WHOLE, ..head.clone() };
            match &whole {
                Some(first) if *first != joined => {
                    let difference = difference(&joined, first);
                    return Err(ExperimentError::Other { path: part.clone(), difference });
                }
                _ => whole = Some(joined),
            }
            let (text, path) = lines::read(part)?;
            for (place, record) in parse(&text, &head, &path)? {
                let known = records.get(&place);
                if known.is_some_and(|known| !known.agrees_with(&record)) {
                    let trial = name(&head.design, &record.trial);
                    return Err(ExperimentError::Code { path: part.clone(), trial });
                }
                // The order of the shares does not matter: a record of an earlier version is replaced
                // by another one.
                if known.is_none_or(|known| known.pose_error.is_none()) {
                    records.insert(place, record);
                }
            }
        }
        let Some(head) = whole else {
            let reason = "no folders to merge".to_owned();
            return Err(ExperimentError::Content { path: folder.to_owned(), reason });
        };
        let trials: Vec<(usize, TrialId)> = head.design.trials().into_iter().enumerate().collect();
        require_all(&head.design, &trials, &records)?;
        let mut merged = Experiment::open(folder, &head.design, Shard::WHOLE)?;
        merged.records = records;
        merged.check_code()?;
        merged.settle()?;
        Ok(merged)
    }

    /// Sorts the lines into the design's order, whatever the threads and interrupts were.
    pub(super) fn settle(&mut self) -> Result<(), ExperimentError> {
        let mut text = Vec::new();
        for record in self.records.values() {
            text.extend(line(record, &self.lines.path)?);
        }
        self.lines.replace(&text)
    }

    /// Runs the first finished trial of each policy again, since another version of the program may
    /// differ in one policy alone.
    fn check_code(&self) -> Result<(), ExperimentError> {
        let mut firsts: Vec<&Record> = Vec::new();
        for record in self.records.values() {
            if firsts.iter().all(|first| first.trial.policy != record.trial.policy) {
                firsts.push(record);
            }
        }
        firsts.par_iter().try_for_each(|record| {
            let site = Site::new(&self.head.design, &record.trial)?;
            let (again, _) = site.run(&self.head.design, &record.trial)?;
            self.require_same(record, &again)
        })
    }

    /// Returns an error if a trial gives another result than before.
    pub(super) fn require_same(
        &self,
        known: &Record,
        again: &Record,
    ) -> Result<(), ExperimentError> {
        if known.agrees_with(again) {
            return Ok(());
        }
        let trial = name(&self.head.design, &known.trial);
        Err(ExperimentError::Code { path: self.folder.clone(), trial })
    }

    /// Returns an error if trials are missing.
    pub(super) fn require_all(&self) -> Result<(), ExperimentError> {
        require_all(&self.head.design, &self.trials, &self.records)
    }

    /// Returns whether all trials of this share are finished.
    pub fn is_complete(&self) -> bool {
        self.records.len() == self.trials.len()
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the design.
    pub fn design(&self) -> &Design {
        &self.head.design
    }

    /// Returns the share.
    pub fn shard(&self) -> Shard {
        self.head.shard
    }

    /// Returns the number of trials of this share.
    pub fn trials(&self) -> usize {
        self.trials.len()
    }

    /// Returns the finished trials, in the design's order.
    pub fn records(&self) -> impl ExactSizeIterator<Item = &Record> {
        self.records.values()
    }
}

/// Describes a trial in words.
fn name(design: &Design, trial: &TrialId) -> String {
    format!(
        "the trial of map {} of level {} with noise {} by {}",
        trial.map,
        design.level(trial),
        trial.noise,
        policy_name(trial.policy)
    )
}

fn read_head(path: &Path) -> Result<Option<Head>, ExperimentError> {
    head::read(path, HEAD.what, HEAD.version)
}

/// The first difference between two experiments.
fn difference(found: &Head, asked: &Head) -> String {
    if found.shard != asked.shard {
        return format!("share {}, expected {}", found.shard, asked.shard);
    }
    head::difference(&found.design, &asked.design)
}

fn share(head: &Head) -> Vec<(usize, TrialId)> {
    let trials = head.design.trials().into_iter().enumerate();
    trials.filter(|(place, _)| head.shard.has(*place)).collect()
}

/// Reads complete lines, each of which must be a trial of this share that has not occurred before.
fn parse(text: &str, head: &Head, path: &Path) -> Result<BTreeMap<usize, Record>, ExperimentError> {
    let places = share(head);
    // Trials are sorted by level, map, noise and the policy's index among all.
    let key = |trial: &TrialId| (trial.level, trial.map, trial.noise, policy_name(trial.policy));
    let places: BTreeMap<_, usize> =
        places.into_iter().map(|(place, trial)| (key(&trial), place)).collect();
    let mut records = BTreeMap::new();
    for (i, line) in text.lines().enumerate() {
        let bad = |reason: String| ExperimentError::Content {
            path: path.to_owned(),
            reason: format!("line {}: {reason}", i + 1),
        };
        let record: Record = serde_json::from_str(line).map_err(|error| bad(error.to_string()))?;
        let of_design = places.get(&key(&record.trial));
        let place = *of_design.ok_or_else(|| bad("a trial of another design".to_owned()))?;
        if records.insert(place, record).is_some() {
            return Err(bad("a trial that occurs twice".to_owned()));
        }
    }
    Ok(records)
}

/// Whether all of some trials are finished.
fn require_all(
    design: &Design,
    trials: &[(usize, TrialId)],
    records: &BTreeMap<usize, Record>,
) -> Result<(), ExperimentError> {
    let mut missing = trials.iter().filter(|(place, _)| !records.contains_key(place));
    let Some((_, first)) = missing.next() else { return Ok(()) };
    let (missing, all) = (1 + missing.count(), trials.len());
    Err(ExperimentError::Incomplete { missing, all, first: name(design, first) })
}
