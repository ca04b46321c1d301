//! Errors of drivers.

use std::fmt;
use std::time::Duration;

use envgen::SpecError;
use thiserror::Error;

use super::limits::MAX_LINE;

/// An error of a driver.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriverError {
    /// A command line that names no program.
    #[error("{0}")]
    Command(&'static str),
    /// The driver cannot be started.
    #[error("it cannot be started: {program:?}: {error}")]
    Start {
        /// The program.
        program: String,
        /// The error of the system.
        error: std::io::Error,
    },
    /// The driver ended or closed one of its ends.
    #[error("{0}")]
    Gone(String),
    /// The driver did not answer in time.
    #[error("no answer within {} s", .0.as_secs_f64())]
    Late(Duration),
    /// All answers of the driver together took too long.
    #[error("its answers took more than {} s together", .0.as_secs_f64())]
    Slow(Duration),
    /// The driver answers lines that it has not read: it wrote more lines than it got, or does not read.
    #[error("it answers lines that it has not read; expected one line per line sent")]
    Deaf,
    /// The driver wrote a line for which it was not asked.
    #[error("an unexpected line: `{0}`; expected one line per line sent")]
    Unasked(String),
    /// A line for the driver cannot be written.
    #[error("a line for it cannot be written: {0}")]
    Line(#[from] serde_json::Error),
    /// The driver's line is too long.
    #[error("a line of more than {MAX_LINE} bytes")]
    TooLong,
    /// A line that is not an answer.
    #[error("a line that is not an answer: {0}")]
    NoReply(String),
    /// A value that is not allowed.
    #[error(transparent)]
    Field(#[from] SpecError),
    /// The map is too large to be sent.
    #[error("it asks for the map, which is too large: {0}")]
    MapSize(String),
    /// The driver gave up.
    #[error("it gave up: {0}")]
    GaveUp(String),
}

/// The error for a field of an answer.
pub(super) fn not_allowed(
    field: &str,
    value: impl fmt::Display,
    allowed: impl Into<String>,
) -> DriverError {
    DriverError::Field(SpecError::new(field, value, allowed))
}
