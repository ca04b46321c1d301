//! Running the trials of an experiment in parallel.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::design::{Design, TrialId};
use super::error::ExperimentError;
use super::lines::Lines;
use super::record::Record;
use super::site::{Held, Sites};
use super::store::Experiment;

/// The progress of an experiment.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Number of finished trials, including those of earlier runs.
    pub done: usize,
    /// Number of trials of this share.
    pub all: usize,
    /// The trial that was finished last.
    pub last: &'a Record,
}

/// What all threads share.
struct Work<'a> {
    design: &'a Design,
    /// The remaining trials, with their indices in the design's order.
    pending: &'a [(usize, TrialId)],
    next: AtomicUsize,
    stop: AtomicBool,
    sites: Sites,
    sink: Mutex<Sink<'a>>,
    watch: &'a (dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync),
    all: usize,
}

struct Sink<'a> {
    lines: &'a mut Lines,
    found: Vec<(usize, Record)>,
    done: usize,
    error: Option<ExperimentError>,
}

impl Experiment {
    /// Runs the remaining trials on `threads` threads, 0 for one per core. `watch` is called after
    /// every finished trial and can stop the experiment, which a later call continues. Returns true if
    /// all trials are finished.
    ///
    /// # Errors
    ///
    /// If no trial can run on a map, or if a file cannot be written. Finished trials stay.
    pub fn run(
        &mut self,
        threads: usize,
        watch: &(dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync),
    ) -> Result<bool, ExperimentError> {
        let pending: Vec<(usize, TrialId)> = self
            .trials
            .iter()
            .filter(|(place, _)| !self.records.contains_key(place))
            .copied()
            .collect();
        let (found, result) =
            run(&self.head.design, &pending, self.trials.len(), threads, &mut self.lines, watch);
        self.records.extend(found);
        result?;
        if !self.is_complete() {
            return Ok(false);
        }
        self.settle()?;
        Ok(true)
    }
}

/// Runs trials on `threads` threads (0 for one per core), and writes each when it ends.
fn run(
    design: &Design,
    pending: &[(usize, TrialId)],
    all: usize,
    threads: usize,
    lines: &mut Lines,
    watch: &(dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync),
) -> (Vec<(usize, Record)>, Result<(), ExperimentError>) {
    let done = all - pending.len();
    let sink = Mutex::new(Sink { lines, found: Vec::new(), done, error: None });
    let work = Work {
        design,
        pending,
        next: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
        sites: Sites::default(),
        sink,
        watch,
        all,
    };
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => return (Vec::new(), Err(ExperimentError::Threads(error.to_string()))),
    };
    pool.broadcast(|_| work.go());
    let sink = work.sink.into_inner().unwrap_or_else(PoisonError::into_inner);
    (sink.found, sink.error.map_or(Ok(()), Err))
}

impl Work<'_> {
    /// The work of one thread, which runs one trial after the other. Neighbours in the list mostly have
    /// the same map, which stays in memory as long as a thread uses it.
    fn go(&self) {
        let mut held: Option<(u32, u32, Held)> = None;
        while !self.stop.load(Ordering::Relaxed) {
            let Some((place, trial)) = self.pending.get(self.next.fetch_add(1, Ordering::Relaxed))
            else {
                return;
            };
            if held
                .as_ref()
                .is_none_or(|(level, map, _)| (*level, *map) != (trial.level, trial.map))
            {
                held = Some((trial.level, trial.map, self.sites.hold(trial)));
            }
            let Some((_, _, map)) = &held else { return };
            let found = map.site(self.design, trial).and_then(|site| site.run(self.design, trial));
            self.take(*place, found.map(|(record, _)| record));
        }
    }

    fn take(&self, place: usize, found: Result<Record, ExperimentError>) {
        let mut sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner);
        // After an error nothing more is written, so that an incomplete line stays the last one.
        if sink.error.is_some() {
            return;
        }
        let written = found.and_then(|record| sink.lines.append(&record).map(|()| record));
        match written {
            Ok(record) => {
                sink.done += 1;
                let progress = Progress { done: sink.done, all: self.all, last: &record };
                if (self.watch)(progress).is_break() {
                    self.stop.store(true, Ordering::Relaxed);
                }
                sink.found.push((place, record));
            }
            Err(error) => {
                self.stop.store(true, Ordering::Relaxed);
                sink.error = Some(error);
            }
        }
    }
}
