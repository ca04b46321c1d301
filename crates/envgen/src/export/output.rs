//! The output files of a command: no file is replaced before all are complete, and no two outputs are the same file.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{ExportError, Format, Job, Writer};
use crate::located::{Locate, Located};
use crate::whole_file::{WholeFile, commit_all, is_same, refuse_inputs};

/// The option that names output files.
const OPTION: &str = "--out";

/// An output file.
#[derive(Clone, Debug)]
pub struct Output {
    /// The name that was given to `--out`, which selects the format.
    pub asked: PathBuf,
    /// The format of the file.
    pub format: Format,
    /// The name of this file. A format can have several files.
    pub path: PathBuf,
    write: Writer,
}

/// The reasons why a file cannot be an output.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The ending of its name does not belong to any format.
    #[error(transparent)]
    Format(#[from] ExportError),
    /// Another output is the same file.
    #[error("is the same file as {OPTION} {}", .0.display())]
    Same(PathBuf),
    /// The file is an input, or it cannot be written.
    #[error(transparent)]
    File(#[from] io::Error),
}

impl Output {
    /// Returns the files for the requested names.
    ///
    /// # Errors
    /// For unknown endings, for files that are named twice, for files that are inputs, and for names that are not
    /// UTF-8 of formats whose files name each other.
    pub fn all(asked: &[PathBuf], inputs: &[PathBuf]) -> Result<Vec<Output>, Located<OutputError>> {
        let mut outputs: Vec<Output> = Vec::new();
        for asked in asked {
            let files = Output::of(asked).map_err(OutputError::Format);
            for output in files.in_option(OPTION, asked.display())? {
                let path = &output.path;
                let same = outputs.iter().find(|other| is_same(&other.path, path));
                let checked = match same {
                    Some(other) => Err(OutputError::Same(other.path.clone())),
                    None => refuse_inputs(path, inputs).map_err(OutputError::File),
                };
                checked.in_option(OPTION, path.display())?;
                outputs.push(output);
            }
        }
        Ok(outputs)
    }

    /// Returns the files of the format that the ending of a name selects.
    fn of(asked: &Path) -> Result<Vec<Output>, ExportError> {
        let format = Format::from_path(asked)?;
        if format.files().len() > 1 && asked.file_name().is_some_and(|name| name.to_str().is_none())
        {
            return Err(ExportError::Name { path: asked.to_owned() });
        }
        let files = format.files().iter().enumerate().map(|(i, &(ending, write))| {
            // The first file keeps the name as it was given, capitals and all.
            let path = if i == 0 { asked.to_owned() } else { asked.with_extension(ending) };
            Output { asked: asked.to_owned(), format, path, write }
        });
        Ok(files.collect())
    }

    /// Begins the file, which appears when it is committed.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(&self) -> Result<WholeFile, Located<io::Error>> {
        WholeFile::create(&self.path).in_option(OPTION, self.path.display())
    }

    /// Checks whether the format can contain a world, by writing it everywhere but to the file.
    ///
    /// # Errors
    /// When the format cannot contain the world.
    pub fn check(&self, job: &Job<'_>) -> Result<(), Located<ExportError>> {
        (self.write)(job, &mut io::sink()).in_option(OPTION, self.path.display())
    }

    /// Writes the file's content.
    ///
    /// # Errors
    /// When the format cannot contain the world, or when the file cannot be written.
    pub fn write(&self, job: &Job<'_>, file: &mut WholeFile) -> Result<(), Located<ExportError>> {
        self.fill(job, file).in_option(OPTION, self.path.display())
    }

    fn fill(&self, job: &Job<'_>, file: &mut WholeFile) -> Result<(), ExportError> {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        (self.write)(job, &mut out).and_then(|()| Ok(out.flush()?))
    }
}

/// Writes a world to a file, in the format that the ending of its name selects, and to the other files of this
/// format. No file appears before all are complete; existing files are replaced.
///
/// ```
/// use envgen::export::{Job, write_whole};
/// use envgen::{Blueprint, Seed, Spec, forest::ForestSpec};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("forest.yaml");
/// let world = ForestSpec::default().generate(Seed(7))?.to_world();
/// let written = write_whole(&Job::for_path(&world, &path), &path)?;
/// assert_eq!(written, [path.clone(), path.with_extension("pgm")]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Names the file, if the ending of its name does not belong to any format, if the format cannot contain the world,
/// or if the file cannot be written.
pub fn write_whole(job: &Job<'_>, path: &Path) -> Result<Vec<PathBuf>, Located<OutputError>> {
    let outputs = Output::of(path).map_err(OutputError::Format).in_file(path)?;
    let mut files = Vec::new();
    for output in &outputs {
        let begun = WholeFile::create(&output.path).map_err(OutputError::File);
        let mut file = begun.in_file(&output.path)?;
        output.fill(job, &mut file).map_err(OutputError::Format).in_file(&output.path)?;
        files.push(file);
    }
    commit_all(files).map_err(|Located { place, error }| Located { place, error: error.into() })?;
    Ok(outputs.into_iter().map(|output| output.path).collect())
}

#[cfg(all(test, unix))]
mod tests {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    use super::*;

    #[test]
    fn files_that_name_each_other_have_names_in_utf_8() {
        let asked = |name: &[u8]| {
            let outputs = Output::all(&[PathBuf::from(OsStr::from_bytes(name))], &[]);
            outputs.map_err(|error| error.to_string())
        };
        let error = asked(b"a\xff.yaml").unwrap_err();
        assert!(error.contains("must be UTF-8") && error.contains("a\u{fffd}.yaml"), "{error}");
        assert!(asked(b"a\xff.ron").is_ok() && asked("\u{e4}.yaml".as_bytes()).is_ok());
    }
}
