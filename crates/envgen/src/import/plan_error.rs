//! Errors of reading files of shapes.

use std::path::PathBuf;

use thiserror::Error;

use crate::error::SpecError;
use crate::file::FileError;

/// The reasons why a file of shapes (from BARN, as GeoJSON or from HouseExpo) could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Reading failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file does not have its format.
    #[error("not {format}: {reason}")]
    Syntax {
        /// The format.
        format: &'static str,
        /// The mistake, and its position.
        reason: String,
    },
    /// A value is not allowed.
    #[error(transparent)]
    Value(#[from] SpecError),
    /// A file that belongs to this one is invalid.
    #[error("{path}: {error}")]
    Beside {
        /// The path of that file.
        path: PathBuf,
        /// The cause.
        error: Box<PlanError>,
    },
}

impl PlanError {
    pub(super) fn syntax(format: &'static str, reason: impl Into<String>) -> Self {
        PlanError::Syntax { format, reason: reason.into() }
    }

    /// Returns the error for a value that is not allowed.
    pub(super) fn value(
        field: &str,
        value: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        SpecError::new(field, value, allowed).into()
    }
}
