//! Files that are written as a whole or not at all, with the errors of experiments.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use envgen::whole_file;

use super::error::ExperimentError;

/// The files of a report, in the folder of an experiment.
pub const REPORT: [&str; 5] =
    ["report.html", "summary.json", "trials.csv", "trials.parquet", "levels.svg"];

/// Creates a folder, and checks that files can be written into it.
pub(crate) fn folder(path: &Path) -> Result<(), ExperimentError> {
    whole_file::create_folder(path)
        .map_err(|source| ExperimentError::File { path: path.to_owned(), source })
}

/// Writes a file under a temporary name first.
pub(super) fn whole(path: &Path, bytes: &[u8]) -> Result<(), ExperimentError> {
    whole_file::write(path, bytes)
        .map_err(|error| ExperimentError::File { path: path.to_owned(), source: error.error })
}

/// Removes the report from the folder of an experiment, if it has one.
pub(super) fn remove_report(folder: &Path) -> Result<(), ExperimentError> {
    for path in REPORT.map(|file| folder.join(file)) {
        match fs::remove_file(&path) {
            Err(source) if source.kind() != ErrorKind::NotFound => {
                return Err(ExperimentError::File { path, source });
            }
            _ => {}
        }
    }
    Ok(())
}
