//! The file of trials: a line is written whole or not at all.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::ExperimentError;
use super::write;

/// The file of the trials, one per line.
pub(super) const TRIALS: &str = "trials.jsonl";

/// The file of the trials.
#[derive(Debug)]
pub(crate) struct Lines {
    pub(crate) path: PathBuf,
    file: File,
    /// Bytes of whole lines.
    len: u64,
}

impl Lines {
    /// Opens the file, and locks it for this process. A last line without its line end is cut off.
    pub(crate) fn open(folder: &Path) -> Result<(Self, String), ExperimentError> {
        let path = folder.join(TRIALS);
        let error = |source| ExperimentError::File { path: path.clone(), source };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(error)?;
        if !file.metadata().map_err(error)?.is_file() {
            let reason = "this is not a file".to_owned();
            return Err(ExperimentError::Content { path, reason });
        }
        // Where files cannot be locked another process cannot be detected.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(ExperimentError::Busy(folder.to_owned()));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(error)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        bytes.truncate(whole);
        file.set_len(whole as u64).map_err(error)?;
        file.seek(SeekFrom::End(0)).map_err(error)?;
        let text = String::from_utf8(bytes).map_err(|_| ExperimentError::Content {
            path: path.clone(),
            reason: "this is not text".to_owned(),
        })?;
        Ok((Lines { path, file, len: whole as u64 }, text))
    }

    /// Adds a trial; if that fails, nothing of it stays if the disk allows.
    pub(crate) fn append<T: Serialize>(&mut self, record: &T) -> Result<(), ExperimentError> {
        let bytes = line(record, &self.path)?;
        match self.file.write_all(&bytes) {
            Ok(()) => {
                self.len += bytes.len() as u64;
                Ok(())
            }
            Err(source) => {
                let cut = self.file.set_len(self.len);
                // What is left of the line is dropped when the file is read next.
                drop(cut);
                Err(ExperimentError::File { path: self.path.clone(), source })
            }
        }
    }

    /// Replaces all lines at once.
    pub(crate) fn replace(&mut self, text: &[u8]) -> Result<(), ExperimentError> {
        write::whole(&self.path, text)?;
        let error = |source| ExperimentError::File { path: self.path.clone(), source };
        let file = OpenOptions::new().append(true).open(&self.path).map_err(error)?;
        // The lock of the old file is released with it; the new file is locked as well.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(ExperimentError::Busy(self.path.clone()));
        }
        self.file = file;
        self.len = text.len() as u64;
        Ok(())
    }
}

/// The whole lines of the file in a folder that is only read, and the path of the file.
pub(crate) fn read(folder: &Path) -> Result<(String, PathBuf), ExperimentError> {
    let path = folder.join(TRIALS);
    let mut text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(source) => return Err(ExperimentError::File { path, source }),
    };
    text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
    Ok((text, path))
}

/// A trial as a line.
pub(crate) fn line<T: Serialize>(record: &T, path: &Path) -> Result<Vec<u8>, ExperimentError> {
    let content = |error: serde_json::Error| ExperimentError::Content {
        path: path.to_owned(),
        reason: error.to_string(),
    };
    let mut bytes = serde_json::to_vec(record).map_err(content)?;
    bytes.push(b'\n');
    Ok(bytes)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::experiment::tests::record;

    #[test]
    fn a_full_disk_is_reported() {
        let path = PathBuf::from("/dev/full");
        let file = OpenOptions::new().write(true).open(&path).unwrap();
        let mut lines = Lines { path, file, len: 0 };
        let reported = lines.append(&record(0, 0, 0, 1.0)).expect_err("full");
        assert!(reported.to_string().starts_with("/dev/full: No space left"), "{reported}");
        assert_eq!(lines.len, 0);
    }
}
