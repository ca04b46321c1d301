//! Files that appear whole or not at all.

use std::fs;
use std::io::Write;
use std::path::Path;

use atomic_write_file::AtomicWriteFile;

use super::store::ExperimentError;

/// Makes a folder, and says whether files can be written into it.
pub(super) fn folder(path: &Path) -> Result<(), ExperimentError> {
    let error = |source| ExperimentError::File { path: path.to_owned(), source };
    fs::create_dir_all(path).map_err(error)?;
    AtomicWriteFile::open(path.join("trial")).and_then(AtomicWriteFile::discard).map_err(error)
}

/// Writes a file under another name first.
pub(super) fn whole(path: &Path, bytes: &[u8]) -> Result<(), ExperimentError> {
    let write = || {
        let mut file = AtomicWriteFile::open(path)?;
        file.write_all(bytes)?;
        file.commit()
    };
    write().map_err(|source| ExperimentError::File { path: path.to_owned(), source })
}
