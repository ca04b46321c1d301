//! The folder of a survey, and running its trials in parallel.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::design::{Survey, SurveyMap};
use super::record::Record;
use super::site::{Failure, Outcome, Site};
use crate::experiment::design::Shard;
use crate::experiment::error::ExperimentError;
use crate::experiment::head;
use crate::experiment::lines::{self, Lines, line};
use crate::trial::LogWorld;

/// Version of the layout of folders. A folder of another version is rejected.
pub const SURVEY_VERSION: u32 = 2;

/// The file that describes what a folder holds.
const HEAD: head::Kind =
    head::Kind { file: head::SURVEY, what: "a survey", version: SURVEY_VERSION };

/// The content of a folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    version: u32,
    shard: Shard,
    /// Number of kinds of worlds that take turns, each of which is in every share; 1 for the whole
    /// survey.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    kinds: usize,
    survey: Survey,
}

fn one() -> usize {
    1
}

fn is_one(count: &usize) -> bool {
    *count == one()
}

/// Numbers of the world, of the condition and of the noise seed.
type Key = (u32, u32, u32);

/// A survey in its folder, which keeps finished trials, whatever happens to the program.
#[derive(Debug)]
pub struct SurveyFolder {
    head: Head,
    records: BTreeMap<Key, Record>,
    lines: Lines,
}

/// The progress of a survey.
#[derive(Clone, Copy, Debug)]
pub struct SurveyProgress<'a> {
    /// Number of finished trials, including those of earlier runs.
    pub done: u64,
    /// Number of trials of this share.
    pub all: u64,
    /// The trial that was finished last.
    pub last: &'a Record,
}

struct Sink<'a> {
    lines: &'a mut Lines,
    records: &'a mut BTreeMap<Key, Record>,
    error: Option<ExperimentError>,
}

impl SurveyFolder {
    /// Begins a survey in a folder, or continues it. A share has the worlds whose numbers belong to it.
    /// An incomplete last line is dropped.
    ///
    /// # Errors
    ///
    /// If the survey is not allowed, or if the folder cannot be written, holds another survey, is in
    /// use, or holds trials that now give other results.
    pub fn open(folder: &Path, survey: &Survey, shard: Shard) -> Result<Self, ExperimentError> {
        SurveyFolder::open_of_kinds(folder, survey, shard, one())
    }

    /// Does the same as [`SurveyFolder::open`] for a survey in which worlds of several kinds take
    /// turns: a share gets worlds of each kind.
    pub(crate) fn open_of_kinds(
        folder: &Path,
        survey: &Survey,
        shard: Shard,
        kinds: usize,
    ) -> Result<Self, ExperimentError> {
        survey.validate()?;
        shard.validate()?;
        let kinds = if shard == Shard::WHOLE { one() } else { kinds };
        let head = Head { version: SURVEY_VERSION, shard, kinds, survey: survey.clone() };
        let (lines, text) = head::lock(folder, &HEAD, &head, head::difference)?;
        let records = parse(&text, &head, &lines.path)?;
        let folder = SurveyFolder { head, records, lines };
        folder.check_code()?;
        Ok(folder)
    }

    /// Returns the survey of which a folder holds a share. It only reads.
    ///
    /// # Errors
    ///
    /// If the folder holds no survey.
    pub fn survey_of(folder: &Path) -> Result<Survey, ExperimentError> {
        Ok(Head::of_share(folder)?.survey)
    }

    /// Returns the share of a survey that a folder holds. It only reads.
    ///
    /// # Errors
    ///
    /// If the folder holds no survey.
    pub fn shard_of(folder: &Path) -> Result<Shard, ExperimentError> {
        Ok(Head::of_share(folder)?.shard)
    }

    /// Merges the shares of a survey into a folder of its own. Shares may overlap.
    ///
    /// # Errors
    ///
    /// If shares have different surveys, if trials differ or are missing (nothing is written then), or
    /// if the folder cannot be written or holds another survey.
    pub fn merge(folder: &Path, parts: &[PathBuf]) -> Result<Self, ExperimentError> {
        let Some(first) = parts.first() else {
            let reason = "no folders to merge".to_owned();
            return Err(ExperimentError::Content { path: folder.to_owned(), reason });
        };
        SurveyFolder::merge_of(&SurveyFolder::survey_of(first)?, folder, parts)
    }

    /// Does the same as [`SurveyFolder::merge`] for a known survey. A share may differ in families of
    /// which it has no world, since these may not be known before the others have run.
    ///
    /// # Errors
    ///
    /// As [`SurveyFolder::merge`], and if the survey is not allowed.
    pub fn merge_of(
        survey: &Survey,
        folder: &Path,
        parts: &[PathBuf],
    ) -> Result<Self, ExperimentError> {
        survey.validate()?;
        let (version, shard, kinds) = (SURVEY_VERSION, Shard::WHOLE, one());
        let whole = Head { version, shard, kinds, survey: survey.clone() };
        let mut records: BTreeMap<Key, Record> = BTreeMap::new();
        for part in parts {
            let head = Head::of_share(part)?;
            let joined = Head { survey: head.with_others_of(survey), ..whole };
            if joined != whole {
                let difference = head::difference(&joined, &whole);
                return Err(ExperimentError::Other { path: part.clone(), difference });
            }
            let (text, path) = lines::read(part)?;
            for (key, record) in parse(&text, &head, &path)? {
                if records.get(&key).is_some_and(|known| *known != record) {
                    let trial = survey.trial(key);
                    return Err(ExperimentError::Code { path: part.clone(), trial });
                }
                records.insert(key, record);
            }
        }
        let keys = survey.maps().flat_map(|map| survey.keys(map.number));
        let mut missing = keys.filter(|key| !records.contains_key(key));
        if let Some(first) = missing.next() {
            return Err(ExperimentError::Incomplete {
                missing: 1 + missing.count(),
                all: whole.all() as usize,
                first: survey.trial(first),
            });
        }
        drop(missing);
        let mut merged = SurveyFolder::open(folder, survey, Shard::WHOLE)?;
        merged.records = records;
        merged.check_code()?;
        merged.settle()?;
        Ok(merged)
    }

    /// Sorts the lines, whatever the threads and interrupts were.
    fn settle(&mut self) -> Result<(), ExperimentError> {
        let mut text = Vec::new();
        for record in self.records.values() {
            text.extend(line(record, &self.lines.path)?);
        }
        self.lines.replace(&text)
    }

    /// Runs the remaining trials on `threads` threads, 0 for one per core. `watch` is called after
    /// every finished trial and can stop the survey, which a later call continues. Returns true if all
    /// trials are finished; the file of trials is then sorted.
    ///
    /// # Errors
    ///
    /// If a file cannot be written, or if a driver fails. Finished trials stay. A world in which no
    /// trial can run is recorded with its failure.
    pub fn run(
        &mut self,
        threads: usize,
        watch: &(dyn Fn(SurveyProgress<'_>) -> ControlFlow<()> + Sync),
    ) -> Result<bool, ExperimentError> {
        let SurveyFolder { head, records, lines } = self;
        let todo: Vec<(SurveyMap<'_>, Vec<Key>)> = head
            .survey
            .maps()
            .filter(|map| head.has(map.number))
            .map(|map| {
                let keys = head.survey.keys(map.number);
                (map, keys.filter(|key| !records.contains_key(key)).collect())
            })
            .filter(|(_, keys): &(_, Vec<Key>)| !keys.is_empty())
            .collect();
        let all = head.all();
        let stop = AtomicBool::new(false);
        let sink = Mutex::new(Sink { lines, records, error: None });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| ExperimentError::Threads(error.to_string()))?;
        pool.install(|| {
            todo.par_iter().for_each(|(map, keys)| {
                let mut site = None;
                for &(_, condition, noise) in keys {
                    if stop.load(Ordering::Relaxed) {
                        return;
                    }
                    let site = &*site.get_or_insert_with(|| place(map));
                    let record = record(&head.survey, map, site, condition, noise);
                    let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
                    if sink.take(record, all, watch).is_break() {
                        stop.store(true, Ordering::Relaxed);
                    }
                }
            });
        });
        let sink = sink.into_inner().unwrap_or_else(PoisonError::into_inner);
        sink.error.map_or(Ok(()), Err)?;
        if !self.is_complete() {
            return Ok(false);
        }
        self.settle()?;
        Ok(true)
    }

    /// Returns the survey.
    pub fn survey(&self) -> &Survey {
        &self.head.survey
    }

    /// Returns the finished trials, by world, condition and noise.
    pub fn records(&self) -> impl ExactSizeIterator<Item = &Record> {
        self.records.values()
    }

    /// Returns whether all trials of this share are finished.
    pub fn is_complete(&self) -> bool {
        self.records.len() as u64 == self.head.all()
    }

    /// Returns the path of the file of trials, with one per line.
    pub fn file(&self) -> &Path {
        &self.lines.path
    }

    /// Returns the number of trials of this share.
    pub fn trials(&self) -> u64 {
        self.head.all()
    }

    /// Runs the first finished trial under each condition and the last one again, since another version
    /// of the program may differ under one condition alone.
    fn check_code(&self) -> Result<(), ExperimentError> {
        let firsts: BTreeMap<u32, &Record> =
            self.records.values().rev().map(|known| (known.condition, known)).collect();
        let last = self.records.values().next_back();
        let known: BTreeSet<Key> = firsts
            .into_values()
            .chain(last)
            .map(|known| (known.map, known.condition, known.noise))
            .collect();
        known.par_iter().try_for_each(|key| self.check_trial(&self.records[key]))
    }

    /// Runs a finished trial again.
    fn check_trial(&self, known: &Record) -> Result<(), ExperimentError> {
        let survey = &self.head.survey;
        let Some(map) = survey.maps().nth(known.map as usize) else { return Ok(()) };
        if record(survey, &map, &place(&map), known.condition, known.noise)? == *known {
            return Ok(());
        }
        let trial = survey.trial((known.map, known.condition, known.noise));
        let path: PathBuf = self.lines.path.clone();
        Err(ExperimentError::Code { path, trial })
    }
}

/// Generates a world of a survey, or returns why it cannot be generated.
fn place(map: &SurveyMap<'_>) -> Result<Site, Failure> {
    let blueprint = map.family.spec.generate(map.seed).map_err(Failure::world)?;
    let world = blueprint.to_world();
    let source = LogWorld::Generated(world.provenance.clone());
    Ok(Site::new(world, source))
}

/// Runs a trial of a survey. A failure of a driver is no result, since it says nothing about the world.
fn record(
    survey: &Survey,
    map: &SurveyMap<'_>,
    site: &Result<Site, Failure>,
    condition: u32,
    noise: u32,
) -> Result<Record, ExperimentError> {
    let noise_seed = survey.noise_seed(map, condition, noise);
    let own = &survey.conditions[condition as usize];
    let outcome = site.as_ref().map_err(Failure::clone).and_then(|site| site.run(own, noise_seed));
    let (world_seed, number) = (map.seed, map.number);
    let empty =
        Record { map: number, condition, noise, world_seed, noise_seed, ..Record::default() };
    match outcome {
        Ok(Outcome { log_digest, end, pose_error, scores }) => {
            Ok(Record { log_digest, end, pose_error, scores: Some(scores), ..empty })
        }
        Err(Failure::World(reason)) => Ok(Record { failure: Some(reason), ..empty }),
        Err(Failure::Driver(reason)) => {
            let (family, condition) = (map.family.name.clone(), own.name.clone());
            Err(ExperimentError::Driver { map: number, family, condition, reason })
        }
    }
}

/// Reads complete lines, each of which must be a trial of this share that has not occurred before.
fn parse(text: &str, head: &Head, path: &Path) -> Result<BTreeMap<Key, Record>, ExperimentError> {
    let survey = &head.survey;
    let own = survey.maps().filter(|map| head.has(map.number));
    let maps: BTreeMap<u32, SurveyMap<'_>> = own.map(|map| (map.number, map)).collect();
    let known: BTreeSet<Key> = maps.keys().flat_map(|number| survey.keys(*number)).collect();
    let mut records = BTreeMap::new();
    for (i, line) in text.lines().enumerate() {
        let bad = |reason: String| ExperimentError::Content {
            path: path.to_owned(),
            reason: format!("line {}: {reason}", i + 1),
        };
        let record: Record = serde_json::from_str(line).map_err(|error| bad(error.to_string()))?;
        let key = (record.map, record.condition, record.noise);
        let map = maps.get(&record.map).filter(|_| known.contains(&key));
        let Some(map) = map else {
            return Err(bad("a trial of another survey".to_owned()));
        };
        let expected = survey.noise_seed(map, record.condition, record.noise);
        if record.noise_seed != expected {
            return Err(bad(format!("`noise_seed` must be {expected}, got {}", record.noise_seed)));
        }
        if records.insert(key, record).is_some() {
            return Err(bad("a trial that occurs twice".to_owned()));
        }
    }
    Ok(records)
}

impl Head {
    /// Reads the head of a share's folder.
    fn of_share(folder: &Path) -> Result<Self, ExperimentError> {
        let path = folder.join(HEAD.file);
        let content = |reason: String| ExperimentError::Content { path: path.clone(), reason };
        let missing = "this file does not exist: the folder holds no share of a survey";
        let head = head::read::<Head>(&path, HEAD.what, HEAD.version)?
            .ok_or_else(|| content(missing.to_owned()))?;
        head.survey.validate().map_err(|error| content(error.to_string()))?;
        head.shard.validate().map_err(|error| content(error.to_string()))?;
        Ok(head)
    }

    /// Returns its survey, with the families of another survey where no world belongs to this share.
    fn with_others_of(&self, other: &Survey) -> Survey {
        let mut survey = self.survey.clone();
        let mut next = 0;
        for (own, other) in survey.families.iter_mut().zip(&other.families) {
            let mut numbers = next..next + own.maps;
            next = numbers.end;
            if own.maps == other.maps && !numbers.any(|number| self.has(number)) {
                own.clone_from(other);
            }
        }
        survey
    }

    /// Whether the world with a number belongs to this share.
    fn has(&self, number: u32) -> bool {
        self.shard.has_of(number as usize, self.kinds)
    }

    /// Number of trials of this share.
    fn all(&self) -> u64 {
        let maps = self.survey.maps().filter(|map| self.has(map.number)).count();
        let per_map = self.survey.conditions.len() as u64 * u64::from(self.survey.noise_seeds);
        maps as u64 * per_map
    }
}

impl Survey {
    /// The name of a trial in errors.
    fn trial(&self, (number, condition, noise): Key) -> String {
        let family = self.maps().nth(number as usize).map_or("", |map| &map.family.name);
        let condition = self.conditions.get(condition as usize).map_or("", |one| &one.name);
        format!("the trial of world {number} ({family}) under `{condition}`, noise seed {noise}")
    }

    fn keys(&self, map: u32) -> impl Iterator<Item = Key> {
        let (conditions, noise_seeds) = (self.conditions.len() as u32, self.noise_seeds);
        (0..conditions).flat_map(move |one| (0..noise_seeds).map(move |noise| (map, one, noise)))
    }
}

impl Sink<'_> {
    fn take(
        &mut self,
        record: Result<Record, ExperimentError>,
        all: u64,
        watch: &(dyn Fn(SurveyProgress<'_>) -> ControlFlow<()> + Sync),
    ) -> ControlFlow<()> {
        // After an error nothing more is written, so that an incomplete line stays the last one.
        if self.error.is_some() {
            return ControlFlow::Break(());
        }
        let written = record.and_then(|record| self.lines.append(&record).map(|()| record));
        let record = match written {
            Ok(record) => record,
            Err(error) => {
                self.error = Some(error);
                return ControlFlow::Break(());
            }
        };
        let key = (record.map, record.condition, record.noise);
        let done = self.records.len() as u64 + 1;
        let next = watch(SurveyProgress { done, all, last: &record });
        self.records.insert(key, record);
        next
    }
}
