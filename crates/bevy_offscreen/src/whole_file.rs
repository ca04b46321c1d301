//! Files that appear completely or not at all.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

use atomic_write_file::AtomicWriteFile;

/// Starts a file that gets its name when it is committed. If the path is a symbolic link, the target of the
/// link is written.
///
/// # Errors
/// Returns an error if the path is a folder or a device, if the existing file is read-only, or if the file
/// system reports an error.
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
    // A file without permission to write must not be replaced either.
    File::options().write(true).open(&target)?;
    AtomicWriteFile::open(target)
}
