//! Why a file of shapes could not be read.

use std::path::PathBuf;

use thiserror::Error;

use crate::error::SpecError;
use crate::file::FileError;

/// Why a file of shapes (of BARN, as GeoJSON or of HouseExpo) could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Reading failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not of its format.
    #[error("not {format}: {reason}")]
    Syntax {
        /// The format.
        format: &'static str,
        /// The mistake, and where it is.
        reason: String,
    },
    /// A value is not allowed.
    #[error(transparent)]
    Value(#[from] SpecError),
    /// A file that belongs to this one is wrong.
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

    /// A value that is not allowed.
    pub(super) fn value(
        field: &str,
        value: impl std::fmt::Display,
        allowed: impl Into<String>,
    ) -> Self {
        SpecError::new(field, value, allowed).into()
    }
}
