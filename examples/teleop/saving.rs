//! Writes the log to disk while the session continues.

use std::path::Path;

use bevy::tasks::futures::check_ready;
use bevy::tasks::{IoTaskPool, Task, TaskPool, block_on};
use envgen::located::Locate;
use envgen::whole_file;
use mapping_trial::trial::TrialLog;

/// Writes at most one log at a time; a newer log replaces the previous one.
#[derive(Default)]
pub(crate) struct Saving(Option<Task<Result<(), String>>>);

impl Saving {
    /// Returns whether the last log is written, or an error if it could not be written.
    pub(crate) fn is_done(&mut self) -> Result<bool, String> {
        let Some(task) = &mut self.0 else { return Ok(true) };
        let Some(written) = check_ready(task) else { return Ok(false) };
        self.0 = None;
        written.map(|()| true)
    }

    /// Waits until the last log is written, so that the folder can be used.
    pub(crate) fn wait(&mut self) -> Result<(), String> {
        self.0.take().map_or(Ok(()), block_on)
    }

    /// Starts to write a log into a folder, on another thread.
    pub(crate) fn begin(&mut self, log: TrialLog, folder: &Path) {
        let folder = folder.to_owned();
        let pool = IoTaskPool::get_or_init(TaskPool::default);
        self.0 = Some(pool.spawn(async move { write(&log, &folder) }));
    }
}

fn write(log: &TrialLog, folder: &Path) -> Result<(), String> {
    let path = folder.join("log.json");
    let mut bytes = Vec::new();
    log.write(&mut bytes).map_err(|error| error.to_string())?;
    std::fs::create_dir_all(folder)
        .in_file(folder)
        .and_then(|()| whole_file::write(&path, &bytes))
        .map_err(|error| error.to_string())
}
