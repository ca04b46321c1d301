//! Files that are written either completely or not at all.
//!
//! A file is written under a temporary name beside its path, and replaces the old file when it is complete. On
//! systems that have files without a name (Linux), even a killed process leaves no file behind.
//!
//! ```
//! use std::io::Write;
//! use envgen::whole_file::WholeFile;
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("notes.txt");
//! let mut file = WholeFile::create(&path)?;
//! file.write_all(b"seed 7")?;
//! assert!(!path.exists());
//! file.commit()?;
//! assert_eq!(std::fs::read(&path)?, b"seed 7");
//! # Ok::<(), std::io::Error>(())
//! ```

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use atomic_write_file::AtomicWriteFile;
use tempfile::TempPath;

use crate::located::{Locate, Located};

/// Prefix of temporary names. Their length does not depend on the file's name.
const PREFIX: &str = ".envgen-";

/// Number of random letters of a temporary name, enough that no two names are alike.
const RANDOM_LETTERS: usize = 16;

/// The greatest number of symbolic links that are followed.
const MAX_LINKS: usize = 40;

/// A file that is being written. If it is dropped without [`WholeFile::commit`], it leaves no file behind, and an
/// old file stays as it was.
#[derive(Debug)]
pub struct WholeFile {
    file: AtomicWriteFile,
    /// The temporary name under which the file is written.
    between: TempPath,
    /// The path as given.
    path: PathBuf,
    /// The path with its links resolved.
    target: PathBuf,
}

impl WholeFile {
    /// Begins a file at a path. If the path is a symbolic link, the file to which it leads is written. An existing
    /// file keeps its mode and owner; a new one gets those of any new file.
    ///
    /// # Errors
    /// When the folder is missing, when the path is a folder or a device, when the existing file is
    /// read-only, or when the system reports an error.
    pub fn create(path: &Path) -> io::Result<Self> {
        let target = followed(path)?;
        let there = match fs::metadata(&target) {
            Ok(there) => Some(writable(&target, there)?),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let folder = folder_of(&target);
        if !folder.is_dir() {
            let text = format!("there is no folder `{}`", folder.display());
            return Err(io::Error::new(ErrorKind::NotFound, text));
        }
        let mut options = AtomicWriteFile::options();
        #[cfg(unix)]
        {
            // They would be the mode and owner of the file with the temporary name.
            use atomic_write_file::unix::OpenOptionsExt;
            options.preserve_mode(false).preserve_owner(false);
        }
        let (file, between) = tempfile::Builder::new()
            .prefix(PREFIX)
            .rand_bytes(RANDOM_LETTERS)
            .make_in(folder, |name| options.open(name))?
            .into_parts();
        if let Some(there) = there {
            keep_owner(file.as_file(), &there);
            file.as_file().set_permissions(there.permissions())?;
        }
        Ok(WholeFile { file, between, path: path.to_owned(), target })
    }

    /// Completes the file and replaces the old one with it.
    ///
    /// # Errors
    /// When the system reports an error. The old file then stays.
    pub fn commit(self) -> io::Result<()> {
        self.complete()?.place()
    }

    /// Writes everything to the disk, under a temporary name.
    fn complete(self) -> io::Result<Complete> {
        self.file.commit()?;
        Ok(Complete { between: self.between, target: self.target })
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A complete file under a temporary name. If it is dropped, it leaves no file behind.
struct Complete {
    between: TempPath,
    target: PathBuf,
}

impl Complete {
    fn place(self) -> io::Result<()> {
        self.between.persist(&self.target)?;
        // The new name must survive a loss of power too; where a system cannot ensure that, the file is
        // kept all the same.
        if cfg!(unix)
            && let Ok(folder) = File::open(folder_of(&self.target))
        {
            folder.sync_all().unwrap_or_default();
        }
        Ok(())
    }
}

/// Commits several files. None is replaced before all are complete.
///
/// # Errors
/// Names the first file for which the system reports an error. Other files can already have been replaced only if
/// the error comes from the final renaming.
pub fn commit_all(files: impl IntoIterator<Item = WholeFile>) -> Result<(), Located<io::Error>> {
    let complete = |file: WholeFile| {
        let path = file.path.clone();
        Ok((file.complete().in_file(&path)?, path))
    };
    let files: Vec<_> = files.into_iter().map(complete).collect::<Result<_, _>>()?;
    files.into_iter().try_for_each(|(file, path)| file.place().in_file(&path))
}

/// Writes a whole file.
///
/// # Errors
/// The errors of [`WholeFile::create`] and [`WholeFile::commit`], with the file's name.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Located<io::Error>> {
    let write = || {
        let mut file = WholeFile::create(path)?;
        file.write_all(bytes)?;
        file.commit()
    };
    write().in_file(path)
}

/// Creates a folder if it does not exist, and checks that files can be written into it.
///
/// # Errors
/// When the system reports an error.
pub fn create_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path)?;
    tempfile::Builder::new().prefix(PREFIX).tempfile_in(path).map(drop)
}

/// Returns whether two paths lead to the same file, with links resolved. The file need not exist.
pub fn is_same(a: &Path, b: &Path) -> bool {
    // Where the target does not exist yet, its folder and name decide.
    let place = |path: &Path| {
        let target = followed(path).ok()?;
        Some(fs::canonicalize(folder_of(&target)).ok()?.join(target.file_name()?))
    };
    same_file::is_same_file(a, b).unwrap_or(false)
        || place(a).is_some_and(|place_of_a| Some(place_of_a) == place(b))
}

/// Returns an error if an output is one of the input files.
///
/// # Errors
/// Names the input file.
pub fn refuse_inputs<P: AsRef<Path>>(output: &Path, inputs: &[P]) -> Result<(), io::Error> {
    match inputs.iter().find(|input| is_same(output, input.as_ref())) {
        None => Ok(()),
        Some(input) => {
            let text = format!("is the input {}, which would be lost", input.as_ref().display());
            Err(io::Error::new(ErrorKind::InvalidInput, text))
        }
    }
}

/// Returns a path with all links resolved, whether or not the target exists.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = folder_of(&path).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("is a link that leads through too many links"))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Returns the metadata of an existing file if it may be replaced.
fn writable(target: &Path, there: fs::Metadata) -> io::Result<fs::Metadata> {
    if there.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "is a folder"));
    }
    if !there.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is a device and not a file"));
    }
    if there.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "exists and is read-only"));
    }
    // A file that may not be written may not be replaced either.
    File::options().write(true).open(target)?;
    Ok(there)
}

/// Gives a file the owner of another file, where the system allows it.
fn keep_owner(file: &File, there: &fs::Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        fchown(file, Some(there.uid()), Some(there.gid())).unwrap_or_default();
    }
    #[cfg(not(unix))]
    let _ = (file, there);
}
