//! The files that a command is asked to write: none before all are complete, none over another.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{ExportError, Format, Job, Writer};
use crate::located::{Locate, Located};
use crate::whole_file::{WholeFile, commit_all, is_same, refuse_inputs};

/// The option that names outputs.
const OPTION: &str = "--out";

/// A file to write.
#[derive(Clone, Debug)]
pub struct Output {
    /// The name given to `--out`, which selects the format.
    pub asked: PathBuf,
    /// The format.
    pub format: Format,
    /// The name of this file; a format can have several.
    pub path: PathBuf,
    write: Writer,
}

/// Why a file cannot be an output.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// Its ending is of no format.
    #[error(transparent)]
    Format(#[from] ExportError),
    /// Another output is the same file.
    #[error("is the same file as {OPTION} {}", .0.display())]
    Same(PathBuf),
    /// It is an input, or it cannot be written.
    #[error(transparent)]
    File(#[from] io::Error),
}

impl Output {
    /// The requested files.
    ///
    /// # Errors
    /// Unknown endings, files that are named twice, and files that are inputs.
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

    /// The files of the format that a name's ending gives.
    fn of(asked: &Path) -> Result<Vec<Output>, ExportError> {
        let format = Format::from_path(asked)?;
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
    /// It cannot be written.
    pub fn create(&self) -> Result<WholeFile, Located<io::Error>> {
        WholeFile::create(&self.path).in_option(OPTION, self.path.display())
    }

    /// Whether the format can hold a world, and such as it: everything but the file.
    ///
    /// # Errors
    /// The format cannot hold the world.
    pub fn check(&self, job: &Job<'_>) -> Result<(), Located<ExportError>> {
        (self.write)(job, &mut io::sink()).in_option(OPTION, self.path.display())
    }

    /// Writes the file's content.
    ///
    /// # Errors
    /// The format cannot hold the world, or the file cannot be written.
    pub fn write(&self, job: &Job<'_>, file: &mut WholeFile) -> Result<(), Located<ExportError>> {
        self.fill(job, file).in_option(OPTION, self.path.display())
    }

    fn fill(&self, job: &Job<'_>, file: &mut WholeFile) -> Result<(), ExportError> {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        (self.write)(job, &mut out).and_then(|()| Ok(out.flush()?))
    }
}

/// Writes a world to a file, in the format that the ending of its name gives, and to the other files of this format.
/// None appears before all are complete; files that exist are replaced.
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
/// Names the file: its ending is of no format, the format cannot hold the world, or it cannot be written.
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
