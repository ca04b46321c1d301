//! How a run ends when it does not succeed.
//!
//! Every error is printed in the form `error: PLACE: TEXT`, where the place is a file, an option with
//! its value, or stdout; [`Locate`](envgen::located::Locate) puts it there.

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use envgen::assignment::AssignmentError;
use envgen::export::{ExportError, OutputError};
use envgen::import::{ImportError, RasterFileError};
use envgen::indoor::{CatalogueError, FolderError};
use envgen::landscape::metrics::RasterError;
use envgen::located::Located;
use envgen::occupancy::OccupancyError;
use envgen::picture::PictureError;
use envgen::scenario::ScenarioFileError;
use envgen::{GenerateError, SettingsError, SpecError};

/// Why a run ends.
pub(crate) enum Failure {
    /// Bad arguments: exit code 2.
    Usage(String),
    /// The work failed: exit code 1.
    Failed(String),
    /// Writing to stdout failed: exit code 1.
    Stdout(io::Error),
    /// The reader of stdout closed it, which is no error: exit code 0.
    ReaderGone,
}

impl Failure {
    /// The failure with the place that it is about.
    pub(crate) fn about(self, place: impl Display) -> Self {
        match self {
            Failure::Usage(text) => Failure::Usage(format!("{place}: {text}")),
            Failure::Failed(text) => Failure::Failed(format!("{place}: {text}")),
            Failure::Stdout(error) => Failure::Failed(format!("{place}: {error}")),
            Failure::ReaderGone => Failure::Failed(format!("{place}: the reader closed the pipe")),
        }
    }

    /// Prints the error on stderr, and returns the exit code.
    pub(crate) fn report(self) -> ExitCode {
        let (text, code) = match self {
            Failure::Usage(text) => (text, 2),
            Failure::Failed(text) => (text, 1),
            Failure::Stdout(error) => (format!("stdout: {error}"), 1),
            Failure::ReaderGone => return ExitCode::SUCCESS,
        };
        print_line(&format!("error: {text}"));
        ExitCode::from(code)
    }
}

/// Prints a line on stderr. That this fails cannot be reported anywhere.
pub(crate) fn print_line(line: &str) {
    writeln!(io::stderr(), "{line}").ok();
}

impl<E: Into<Failure>> From<Located<E>> for Failure {
    fn from(Located { place, error }: Located<E>) -> Self {
        error.into().about(place)
    }
}

/// An error of writing to stdout: those of files are [`Located`].
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::ReaderGone,
            _ => Failure::Stdout(error),
        }
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        io::Error::from(error).into()
    }
}

impl From<GenerateError> for Failure {
    fn from(error: GenerateError) -> Self {
        match error {
            GenerateError::Spec(error) => error.into(),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::UnknownEnding { .. }
            | ExportError::Feature { .. }
            | ExportError::Name { .. } => Failure::Usage(error.to_string()),
            ExportError::Io(error) => error.into(),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Format(error) => error.into(),
            other => Failure::Usage(other.to_string()),
        }
    }
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::UnknownEnding { .. } => Failure::Usage(error.to_string()),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<RasterFileError> for Failure {
    fn from(error: RasterFileError) -> Self {
        match error {
            RasterFileError::UnknownEnding(_) => Failure::Usage(error.to_string()),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<FolderError> for Failure {
    fn from(error: FolderError) -> Self {
        match error {
            FolderError::Read { .. } | FolderError::Missing(_) => {
                Failure::Failed(error.to_string())
            }
            other => Failure::Usage(other.to_string()),
        }
    }
}

impl From<RasterError> for Failure {
    fn from(error: RasterError) -> Self {
        Failure::Failed(error.to_string())
    }
}

/// Errors that mean bad arguments.
macro_rules! usage {
    ($($error:ty),+) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Failure::Usage(error.to_string())
            }
        })+
    };
}

usage!(
    AssignmentError,
    CatalogueError,
    OccupancyError,
    PictureError,
    ScenarioFileError,
    SettingsError,
    SpecError
);
