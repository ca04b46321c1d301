//! Files that are written as a whole or not at all, with the errors of experiments.

use std::path::Path;

use envgen::whole_file;

use super::error::ExperimentError;

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
