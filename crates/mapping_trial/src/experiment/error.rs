//! Errors of experiments.

use std::io;
use std::path::PathBuf;

use envgen::{Seed, SpecError};
use thiserror::Error;

/// An error that stops an experiment.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The design is not allowed.
    #[error(transparent)]
    Design(#[from] SpecError),
    /// The survey is not allowed.
    #[error(transparent)]
    Survey(#[from] super::survey::SurveyError),
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The content of a file is not valid.
    #[error("{}: {reason}", path.display())]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A folder holds another experiment.
    #[error(
        "{} holds another experiment: {difference}; choose another folder, or start again",
        path.display()
    )]
    Other {
        /// The folder.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A folder's trials now give other results.
    #[error(
        "{} was made by another version of this program or of a driver: {trial} now gives another result; \
         choose another folder, or start again",
        path.display()
    )]
    Code {
        /// The folder.
        path: PathBuf,
        /// The trial.
        trial: String,
    },
    /// Another process is using the folder.
    #[error("{}: another process uses this folder", .0.display())]
    Busy(PathBuf),
    /// Trials are missing.
    #[error("{missing} of {all} trials are missing, the first is {first}")]
    Incomplete {
        /// Number of missing trials.
        missing: usize,
        /// Number of all trials.
        all: usize,
        /// The first missing trial.
        first: String,
    },
    /// A map cannot be generated, or no trial can run on it.
    #[error("map {map} of level {level} (seed {seed}): {reason}")]
    Map {
        /// Number of the map within the level.
        map: u32,
        /// Level of the map.
        level: f64,
        /// Seed of the map.
        seed: Seed,
        /// The reason.
        reason: String,
    },
    /// A world cannot be generated, described or measured.
    #[error("{world}: {reason}")]
    World {
        /// Description of the world.
        world: String,
        /// The reason.
        reason: String,
    },
    /// A driver failed. Nothing is kept of such a trial.
    #[error("world {map} ({family}), condition {condition}: the driver failed: {reason}")]
    Driver {
        /// Number of the world in the survey.
        map: u32,
        /// Name of its family.
        family: String,
        /// Name of the condition.
        condition: String,
        /// What the driver did.
        reason: String,
    },
    /// The threads cannot be started.
    #[error("threads cannot be started: {0}")]
    Threads(String),
    /// The report cannot be drawn.
    #[error("the report cannot be drawn: {0}")]
    Report(String),
    /// The same error as that of another thread.
    #[error("{0}")]
    Again(String),
}

impl ExperimentError {
    /// Copies the error for other threads that need the same map.
    pub(super) fn again(&self) -> ExperimentError {
        match self {
            ExperimentError::Map { map, level, seed, reason } => ExperimentError::Map {
                map: *map,
                level: *level,
                seed: *seed,
                reason: reason.clone(),
            },
            other => ExperimentError::Again(other.to_string()),
        }
    }
}
