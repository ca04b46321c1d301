//! Files that appear whole or not at all.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use atomic_write_file::AtomicWriteFile;

use crate::failure::Failure;

/// Files under temporary names beside their places. Dropped without [`Pending::commit`], nothing
/// is left.
#[derive(Default)]
pub(crate) struct Pending(Vec<(AtomicWriteFile, PathBuf)>);

impl Pending {
    /// Writes one file.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if path.is_dir() {
            return Err(Failure::of_file(path, "is a folder"));
        }
        if !folder.is_dir() {
            let text = format!("there is no folder `{}`", folder.display());
            return Err(Failure::of_file(path, text));
        }
        let file = AtomicWriteFile::open(path).map_err(|error| Failure::of_file(path, error))?;
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write(&mut out)?;
        let file = out.into_inner().map_err(|error| Failure::of_file(path, error.error()))?;
        self.0.push((file, path.to_owned()));
        Ok(())
    }

    /// Gives every file its name.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        for (file, path) in self.0 {
            file.commit().map_err(|error| Failure::of_file(&path, error))?;
        }
        Ok(())
    }
}
