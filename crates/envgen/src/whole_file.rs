//! Files that appear whole or not at all.
//!
//! A file is written beside its place and takes the place of the old one when it is complete. Where
//! the system has files without a name (Linux), nothing is left even of a process that is killed.
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

/// Beginning of the temporary names, which do not grow with the files' own.
const PREFIX: &str = ".envgen-";

/// Random letters of a temporary name: two are never alike.
const RANDOM_LETTERS: usize = 16;

/// Links that are followed from one to the next.
const MAX_LINKS: usize = 40;

/// A file to be. Dropped without [`WholeFile::commit`], it leaves nothing, and what was in its place
/// stays.
#[derive(Debug)]
pub struct WholeFile {
    file: AtomicWriteFile,
    /// The name between the end of writing and the place.
    between: TempPath,
    /// As it was given.
    path: PathBuf,
    /// Where its links lead.
    target: PathBuf,
}

impl WholeFile {
    /// A new file for a place. Where that is a link, the file that it leads to is meant. A file that
    /// is already there keeps its mode and owner; a new one gets those of any new file.
    ///
    /// # Errors
    /// When the folder is missing, when a folder or a device is in the place, when the file there
    /// may not be written, or what the system says.
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
            // They would be those of the temporary name.
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

    /// Puts the file, which is complete, into its place.
    ///
    /// # Errors
    /// What the system says; then what was in the place is still there.
    pub fn commit(self) -> io::Result<()> {
        self.complete()?.place()
    }

    /// Brings everything to the disk, under a temporary name.
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

/// A complete file under a temporary name. Dropped, it leaves nothing.
struct Complete {
    between: TempPath,
    target: PathBuf,
}

impl Complete {
    fn place(self) -> io::Result<()> {
        self.between.persist(&self.target)?;
        // The name as well is to outlive a loss of power; that some systems cannot promise it does
        // not undo the file.
        if cfg!(unix)
            && let Ok(folder) = File::open(folder_of(&self.target))
        {
            folder.sync_all().unwrap_or_default();
        }
        Ok(())
    }
}

/// Puts several files into their places, none before all are complete.
///
/// # Errors
/// The first file for which the system has an objection. Only where files get their names can
/// others have got theirs before.
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
/// As [`WholeFile::create`] and [`WholeFile::commit`], with the file's name.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Located<io::Error>> {
    let write = || {
        let mut file = WholeFile::create(path)?;
        file.write_all(bytes)?;
        file.commit()
    };
    write().in_file(path)
}

/// Makes a folder if need be, and says whether files can be written into it.
///
/// # Errors
/// What the system says.
pub fn create_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path)?;
    tempfile::Builder::new().prefix(PREFIX).tempfile_in(path).map(drop)
}

/// Whether two names mean the same file, over links and whether or not it is there yet.
pub fn is_same(a: &Path, b: &Path) -> bool {
    // Where the last link leads to nothing yet, the folder and the name decide.
    let place = |path: &Path| {
        let target = followed(path).ok()?;
        Some(fs::canonicalize(folder_of(&target)).ok()?.join(target.file_name()?))
    };
    same_file::is_same_file(a, b).unwrap_or(false)
        || place(a).is_some_and(|place_of_a| Some(place_of_a) == place(b))
}

/// Refuses a file to write that is one of the files that were read.
///
/// # Errors
/// Names the file that was read.
pub fn refuse_inputs<P: AsRef<Path>>(output: &Path, inputs: &[P]) -> Result<(), io::Error> {
    match inputs.iter().find(|input| is_same(output, input.as_ref())) {
        None => Ok(()),
        Some(input) => {
            let text = format!("is the input {}, which would be lost", input.as_ref().display());
            Err(io::Error::new(ErrorKind::InvalidInput, text))
        }
    }
}

/// Where the links of a name lead in the end, whether something is there or not.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = folder_of(&path).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("is a link that leads to no end"))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// What is in a file's place, if it may be replaced.
fn writable(target: &Path, there: fs::Metadata) -> io::Result<fs::Metadata> {
    if there.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "is a folder"));
    }
    if !there.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is a device and not a file"));
    }
    if there.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "is there and read-only"));
    }
    // Whoever may not write the file may not replace it either.
    File::options().write(true).open(target)?;
    Ok(there)
}

/// Gives a file the owner of another, where the system lets one.
fn keep_owner(file: &File, there: &fs::Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        fchown(file, Some(there.uid()), Some(there.gid())).unwrap_or_default();
    }
    #[cfg(not(unix))]
    let _ = (file, there);
}
