//! What stops an experiment.

use std::io;
use std::path::PathBuf;

use envgen::{Seed, SpecError};
use thiserror::Error;

/// Why an experiment cannot continue.
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
        /// Its path.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file has wrong content.
    #[error("{}: {reason}", path.display())]
    Content {
        /// Its path.
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
    /// Another process uses the folder.
    #[error("{}: another process uses this folder", .0.display())]
    Busy(PathBuf),
    /// Trials are missing.
    #[error("{missing} of {all} trials are missing, the first is {first}")]
    Incomplete {
        /// How many.
        missing: usize,
        /// Out of how many.
        all: usize,
        /// One of them.
        first: String,
    },
    /// A map cannot be generated, or no trial can run on it.
    #[error("map {map} of level {level} (seed {seed}): {reason}")]
    Map {
        /// Its number within the level.
        map: u32,
        /// Its level.
        level: f64,
        /// Its seed.
        seed: Seed,
        /// Why.
        reason: String,
    },
    /// A world cannot be generated, described or measured.
    #[error("{world}: {reason}")]
    World {
        /// Which world.
        world: String,
        /// Why.
        reason: String,
    },
    /// A driver failed: of such a trial nothing is kept.
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
    /// A copy of the error, for other threads that need the same map.
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
