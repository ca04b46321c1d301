//! Trials in the edited world, in the program `teleop`.

use std::env::consts::EXE_SUFFIX;
use std::error::Error;
use std::io;
use std::path::Path;
use std::process::{Child, Command};

use envgen::edit::Document;
use envgen::indoor::Catalogue;
use tempfile::TempDir;

use crate::saving;

/// Name of the program that runs trials, which is beside this one.
const PROGRAM: &str = "teleop";

/// The opened trials. Their worlds are files that are removed at the end.
#[derive(Default)]
pub(crate) struct Trials {
    folder: Option<TempDir>,
    count: u32,
    running: Vec<Child>,
}

impl Trials {
    /// Saves the world to a file of its own and opens a trial in it, if the program exists. Otherwise,
    /// returns the command that does it.
    pub(crate) fn open(
        &mut self,
        document: &Document,
        catalogue: &Catalogue,
    ) -> Result<String, Box<dyn Error>> {
        if self.folder.is_none() {
            self.folder = Some(tempfile::Builder::new().prefix("envgen-edit-").tempdir()?);
        }
        let folder = self.folder.as_ref().map_or(Path::new("."), TempDir::path);
        self.count += 1;
        let world = folder.join(format!("world_{}.ron", self.count));
        saving::save(document, catalogue, &world)?;
        let program = std::env::current_exe()?.with_file_name(format!("{PROGRAM}{EXE_SUFFIX}"));
        // Who edits the world knows it, so that trials in it are not blind.
        let options = format!("--known --world {}", world.display());
        match Command::new(&program).args(["--known", "--world"]).arg(&world).spawn() {
            Ok(child) => {
                self.running.push(child);
                Ok(format!("opened a trial: {PROGRAM} {options}"))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(format!(
                "run: cargo run --release --features window --example {PROGRAM} -- {options}"
            )),
            Err(error) => Err(format!("{}: {error}", program.display()).into()),
        }
    }

    /// Returns the error of a trial that has failed, if there is one.
    pub(crate) fn poll(&mut self) -> Option<String> {
        let mut failure = None;
        self.running.retain_mut(|child| match child.try_wait() {
            Ok(None) => true,
            Ok(Some(status)) => {
                if !status.success() {
                    failure = Some(format!("the trial has failed ({status}): see the terminal"));
                }
                false
            }
            Err(error) => {
                failure = Some(format!("the trial: {error}"));
                false
            }
        });
        failure
    }
}
