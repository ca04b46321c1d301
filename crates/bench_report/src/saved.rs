//! What benchmarks printed, kept until they run again.

use std::error::Error;
use std::path::{Path, PathBuf};

use envgen::whole_file;
use serde::{Deserialize, Serialize};

use crate::machine::Machine;

/// A run of a benchmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Saved {
    pub(crate) machine: Machine,
    /// How long it took.
    pub(crate) seconds: f64,
    /// What it printed.
    pub(crate) printed: String,
}

/// The folder of all runs.
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// The folder in that of the builds; it is created if it does not exist.
    pub(crate) fn within(target: &Path) -> Result<Self, Box<dyn Error>> {
        let folder = target.join("bench_report");
        std::fs::create_dir_all(&folder)?;
        Ok(Folder(folder))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(format!("{}.json", name.replace('/', "-")))
    }

    /// The last run of a benchmark on such a machine.
    pub(crate) fn read(&self, name: &str, machine: &Machine) -> Option<Saved> {
        let text = std::fs::read(self.file(name)).ok()?;
        let saved: Saved = serde_json::from_slice(&text).ok()?;
        saved.machine.is_like(machine).then_some(saved)
    }

    /// Keeps a run.
    pub(crate) fn write(&self, name: &str, saved: &Saved) -> Result<(), Box<dyn Error>> {
        Ok(whole_file::write(&self.file(name), &serde_json::to_vec_pretty(saved)?)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_other_machines_and_broken_files_do_not_count() -> Result<(), Box<dyn Error>> {
        let target = tempfile::tempdir()?;
        let folder = Folder::within(target.path())?;
        let saved = Saved { machine: Machine::here(), seconds: 0.1, printed: "a\n".to_owned() };
        folder.write("a/b", &saved)?;
        assert_eq!(folder.read("a/b", &Machine::here()), Some(saved.clone()));
        let other = Machine { cores: saved.machine.cores + 1, ..Machine::here() };
        assert_eq!(folder.read("a/b", &other), None);
        std::fs::write(folder.file("a/b"), "{")?;
        assert_eq!((folder.read("a/b", &Machine::here()), folder.read("c", &other)), (None, None));
        Ok(())
    }
}
