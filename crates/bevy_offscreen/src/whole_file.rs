//! Files that appear completely or not at all.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

use atomic_write_file::AtomicWriteFile;

/// Begins a file that gets its name when it is committed. Where the path is a link, the file that it
/// leads to is written.
///
/// # Errors
/// When the path is a folder or a device, when the existing file is read-only, or when the system
/// reports an error.
pub(crate) fn create(path: &Path) -> io::Result<AtomicWriteFile> {
    let target = match fs::canonicalize(path) {
        Ok(target) => target,
        Err(error) if error.kind() == ErrorKind::NotFound => return AtomicWriteFile::open(path),
        Err(error) => return Err(error),
    };
    let there = fs::metadata(&target)?;
    if !there.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is a folder or a device"));
    }
    if there.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "exists and is read-only"));
    }
    // A file that may not be written may not be replaced either.
    File::options().write(true).open(&target)?;
    AtomicWriteFile::open(target)
}
