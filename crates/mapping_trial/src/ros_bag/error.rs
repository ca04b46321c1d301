//! Errors of bags.

use std::io;

use envgen::file::FileError;
use envgen::occupancy::OccupancyError;
use thiserror::Error;

/// An error for which a trial has no bag.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BagError {
    /// The bag could not be written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The map is too large for a message.
    #[error("`/map`: {0}")]
    Map(#[from] OccupancyError),
    /// The world cannot be written.
    #[error("the attachment `world.json`: {0}")]
    World(#[from] FileError),
    /// No trial was built with the recorder's parts.
    #[error("the recorder watched no trial: build the trial with `BagRecorder::watch`")]
    NoTrial,
    /// More than one trial was built with the recorder's parts.
    #[error("the recorder watched more than one trial, expected one")]
    ManyTrials,
}
