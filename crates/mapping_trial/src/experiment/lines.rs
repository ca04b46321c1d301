//! The file of trials, in which a line is written as a whole or not at all.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::ExperimentError;
use super::write;

/// Name of the file of trials, with one per line.
pub(super) const TRIALS: &str = "trials.jsonl";

/// The file of the trials.
#[derive(Debug)]
pub(crate) struct Lines {
    pub(crate) path: PathBuf,
    file: File,
    /// Number of bytes that are kept.
    len: u64,
}

impl Lines {
    /// Opens the file, locks it for this process, and returns it with its complete lines. What comes
    /// after them stays until [`Lines::drop_rest`].
    pub(crate) fn open(folder: &Path) -> Result<(Self, String), ExperimentError> {
        let mut lines = Lines::lock(folder)?;
        let path = lines.path.clone();
        let mut bytes = Vec::new();
        let read = lines.file.read_to_end(&mut bytes);
        read.map_err(|source| ExperimentError::File { path: path.clone(), source })?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        bytes.truncate(whole);
        let text = String::from_utf8(bytes).map_err(|_| ExperimentError::Content {
            path,
            reason: "this is not text".to_owned(),
        })?;
        Ok((lines, text))
    }

    /// Whether the file is empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Cuts off what comes after the complete lines: a last line without its line end.
    pub(crate) fn drop_rest(&mut self, text: &str) -> Result<(), ExperimentError> {
        self.cut(text.len() as u64)
    }

    /// Opens the file, and locks it for this process.
    pub(crate) fn lock(folder: &Path) -> Result<Self, ExperimentError> {
        let path = folder.join(TRIALS);
        let error = |source| ExperimentError::File { path: path.clone(), source };
        // The file is opened for appending, so that a line that was written in part and cut off leaves
        // no gap.
        let mut options = OpenOptions::new();
        options.read(true).append(true).create(true);
        let file = options.open(&path).map_err(error)?;
        let metadata = file.metadata().map_err(error)?;
        if !metadata.is_file() {
            let reason = "this is not a file".to_owned();
            return Err(ExperimentError::Content { path, reason });
        }
        // Where files cannot be locked, another process cannot be detected.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(ExperimentError::Busy(folder.to_owned()));
        }
        Ok(Lines { path, file, len: metadata.len() })
    }

    /// Keeps only the first bytes of the file.
    pub(crate) fn cut(&mut self, len: u64) -> Result<(), ExperimentError> {
        let error = |source| ExperimentError::File { path: self.path.clone(), source };
        self.file.set_len(len).map_err(error)?;
        self.len = len;
        Ok(())
    }

    /// Appends a trial. If that fails, nothing of it stays, if the disk allows.
    pub(crate) fn append<T: Serialize>(&mut self, record: &T) -> Result<(), ExperimentError> {
        let bytes = line(record, &self.path)?;
        match self.file.write_all(&bytes) {
            Ok(()) => {
                self.len += bytes.len() as u64;
                Ok(())
            }
            Err(source) => {
                let cut = self.file.set_len(self.len);
                // The rest of the line is dropped when the file is next read.
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

/// Returns the complete lines of the file in a folder that is only read, and the path of the file.
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
    fn a_line_after_one_that_was_cut_off_leaves_no_gap() {
        let folder = tempfile::tempdir().unwrap();
        let (mut lines, _) = Lines::open(folder.path()).unwrap();
        lines.append(&record(0, 0, 0, 1.0)).unwrap();
        lines.file.write_all(b"half a li").unwrap();
        lines.cut(lines.len).unwrap();
        lines.append(&record(0, 1, 0, 1.0)).unwrap();
        lines.file.write_all(b"half a li").unwrap();
        drop(lines);
        let (mut lines, text) = Lines::open(folder.path()).unwrap();
        lines.drop_rest(&text).unwrap();
        assert_eq!((text.lines().count(), text.len() as u64), (2, lines.len));
        assert!(text.lines().all(|line| line.starts_with('{') && line.ends_with('}')), "{text}");
    }

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
