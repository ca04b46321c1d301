//! How a run ends when it does not succeed.

use std::fmt::Display;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use envgen::export::ExportError;
use envgen::file::FileError;
use envgen::{GenerateError, SettingsError};

/// Why a run ends.
pub(crate) enum Failure {
    /// What was asked cannot be: exit code 2.
    Usage(String),
    /// What was asked did not come about: exit code 1.
    Failed(String),
    /// The reader of the output has gone, which is its right: exit code 0.
    ReaderGone,
}

impl Failure {
    /// A failure to read or write a file, by its name.
    pub(crate) fn of_file(path: &Path, error: impl Display) -> Self {
        Failure::Failed(format!("{}: {error}", path.display()))
    }

    /// Says on stderr what is wrong, and gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        let (text, code) = match self {
            Failure::Usage(text) => (text, 2),
            Failure::Failed(text) => (text, 1),
            Failure::ReaderGone => return ExitCode::SUCCESS,
        };
        #[expect(clippy::print_stderr, reason = "this is where the command says what is wrong")]
        {
            eprintln!("error: {text}");
        }
        ExitCode::from(code)
    }
}

impl From<SettingsError> for Failure {
    fn from(error: SettingsError) -> Self {
        Failure::Usage(error.to_string())
    }
}

impl From<GenerateError> for Failure {
    fn from(error: GenerateError) -> Self {
        match error {
            GenerateError::Spec(error) => Failure::Usage(error.to_string()),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::UnknownEnding { .. } => Failure::Usage(error.to_string()),
            ExportError::Io(error) => error.into(),
            other => Failure::Failed(other.to_string()),
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Failure::Failed(error.to_string())
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::ReaderGone,
            _ => Failure::Failed(error.to_string()),
        }
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        io::Error::from(error).into()
    }
}
