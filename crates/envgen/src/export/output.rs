//! The files that a command is asked to write: none before all are complete, none over another.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use thiserror::Error;

use super::{ExportError, Format, Job, Writer};
use crate::located::{Locate, Located};
use crate::whole_file::{WholeFile, is_same, refuse_inputs};

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
            let format = Format::from_path(asked).map_err(OutputError::Format);
            let format = format.in_option(OPTION, asked.display())?;
            for (i, &(ending, write)) in format.files().iter().enumerate() {
                // The first file keeps the name as it was given, capitals and all.
                let path = if i == 0 { asked.clone() } else { asked.with_extension(ending) };
                let same = outputs.iter().find(|other| is_same(&other.path, &path));
                let checked = match same {
                    Some(other) => Err(OutputError::Same(other.path.clone())),
                    None => refuse_inputs(&path, inputs).map_err(OutputError::File),
                };
                checked.in_option(OPTION, path.display())?;
                outputs.push(Output { asked: asked.clone(), format, path, write });
            }
        }
        Ok(outputs)
    }

    /// Begins the file, which appears when it is committed.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(&self) -> Result<WholeFile, Located<io::Error>> {
        WholeFile::create(&self.path).in_option(OPTION, self.path.display())
    }

    /// Writes the file's content.
    ///
    /// # Errors
    /// The format cannot hold the world, or the file cannot be written.
    pub fn write(&self, job: &Job<'_>, file: &mut WholeFile) -> Result<(), Located<ExportError>> {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        let written = (self.write)(job, &mut out).and_then(|()| Ok(out.flush()?));
        written.in_option(OPTION, self.path.display())
    }
}
