//! Findings about the world, computed on other threads after every change.

use std::sync::Arc;

use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, futures_lite::future};
use envgen::World;
use envgen::calibration::Prediction;
use envgen::edit::{Audit, Document, predict};

/// The last findings, which may be for an earlier state, and those that are being computed.
#[derive(Default)]
pub(crate) struct Auditing {
    pub(crate) audit: Latest<Audit>,
    /// The prediction, which takes longer. What is out of reach does not wait for it.
    pub(crate) prediction: Latest<Option<Prediction>>,
}

impl Auditing {
    /// Whether something is being computed.
    pub(crate) fn is_running(&self) -> bool {
        self.audit.is_running() || self.prediction.is_running()
    }

    /// Takes finished results, and starts the computations for the present state.
    pub(crate) fn poll(&mut self, document: &Document, revision: u64) {
        let promises = || document.promises();
        self.audit.poll(revision, || {
            let (world, promises) = (Arc::clone(document.world()), promises());
            move || Audit::of(&world, &promises)
        });
        self.prediction.poll(revision, || {
            let world: Arc<World> = Arc::clone(document.world());
            move || predict(&world)
        });
    }
}

/// A finding for the last state for which it is known.
pub(crate) struct Latest<T> {
    found: Option<T>,
    /// The state for which it holds.
    revision: u64,
    running: Option<(u64, Task<T>)>,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Latest { found: None, revision: 0, running: None }
    }
}

impl<T: Send + 'static> Latest<T> {
    /// Returns the finding, if there is one yet.
    pub(crate) fn get(&self) -> Option<&T> {
        self.found.as_ref()
    }

    /// Returns the finding if it is for a state. What it names by index may be something else in another.
    pub(crate) fn of(&self, revision: u64) -> Option<&T> {
        self.found.as_ref().filter(|_| self.revision == revision)
    }

    /// Whether it is not for the present state.
    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Runs one computation at a time. States between the one that is running and the present one are
    /// skipped.
    fn poll<F: FnOnce() -> T + Send + 'static>(&mut self, revision: u64, job: impl FnOnce() -> F) {
        if let Some((of, task)) = &mut self.running {
            let Some(found) = block_on(future::poll_once(task)) else { return };
            (self.found, self.revision) = (Some(found), *of);
            self.running = None;
        }
        if self.revision != revision {
            let job = job();
            let task = AsyncComputeTaskPool::get().spawn(async move { job() });
            self.running = Some((revision, task));
        }
    }
}
