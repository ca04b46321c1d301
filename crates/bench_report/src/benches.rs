//! The benchmarks of the workspace, and their runs.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use bench_ratio::{Growth, Ratio};
use serde::Deserialize;

/// The workspace: its benchmarks in alphabetical order, and where builds go.
pub(crate) struct Workspace {
    pub(crate) benches: Vec<Bench>,
    pub(crate) target: PathBuf,
}

/// A benchmark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Bench {
    package: String,
    /// The folder of its package.
    folder: PathBuf,
    target: String,
    /// Its source.
    source: PathBuf,
    features: Vec<String>,
}

/// The lines that a benchmark printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Results {
    pub(crate) ratios: Vec<Ratio>,
    pub(crate) growths: Vec<Growth>,
    /// All other lines.
    pub(crate) others: Vec<String>,
}

/// The part of `cargo metadata` that is read.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    target_directory: PathBuf,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    manifest_path: PathBuf,
    targets: Vec<Target>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
    src_path: PathBuf,
    #[serde(default, rename = "required-features")]
    required_features: Vec<String>,
}

/// The part of cargo's messages of a build that is read.
#[derive(Deserialize)]
struct Message {
    target: Option<Target>,
    executable: Option<PathBuf>,
}

impl Workspace {
    /// The workspace of the current folder.
    pub(crate) fn here() -> Result<Self, Box<dyn Error>> {
        let output = cargo().args(["metadata", "--no-deps", "--format-version", "1"]).output()?;
        succeeded("cargo metadata", &output)?;
        Ok(Workspace::of(serde_json::from_slice(&output.stdout)?))
    }

    fn of(metadata: Metadata) -> Self {
        let mut benches = Vec::new();
        for Package { name: package, manifest_path, targets } in metadata.packages {
            let is_bench = |target: &Target| target.kind.iter().any(|kind| kind == "bench");
            for target in targets.into_iter().filter(is_bench) {
                benches.push(Bench {
                    package: package.clone(),
                    folder: manifest_path.parent().unwrap_or(Path::new(".")).to_owned(),
                    target: target.name,
                    source: target.src_path,
                    features: target.required_features,
                });
            }
        }
        benches.sort_by_key(Bench::name);
        Workspace { benches, target: metadata.target_directory }
    }
}

/// Builds benchmarks, so that nothing is built while one runs; the program of each, by its source. Those that need the
/// same features are one build, with the features of the whole workspace: dependencies are built once. Names are unique, so that
/// nothing else is built.
pub(crate) fn build(benches: &[&Bench]) -> Result<BTreeMap<PathBuf, PathBuf>, Box<dyn Error>> {
    let mut programs = BTreeMap::new();
    let groups: BTreeSet<Vec<String>> = benches.iter().map(|bench| bench.all_features()).collect();
    for features in groups {
        let own = benches.iter().filter(|bench| bench.all_features() == features);
        let mut command = cargo();
        command.args(["bench", "--no-run", "--message-format", "json-render-diagnostics"]);
        command.args(own.flat_map(|bench| ["--bench", &bench.target]));
        if !features.is_empty() {
            command.args(["--features", &features.join(",")]);
        }
        // Cargo shows how far it is.
        let output = command.stderr(Stdio::inherit()).output()?;
        succeeded("building the benchmarks", &output)?;
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            let message: Message = serde_json::from_str(line)?;
            if let (Some(target), Some(program)) = (message.target, message.executable) {
                programs.insert(target.src_path, program);
            }
        }
    }
    Ok(programs)
}

impl Bench {
    /// Package and target, such as `envgen/forest`.
    pub(crate) fn name(&self) -> String {
        format!("{}/{}", self.package, self.target)
    }

    /// Whether its name, or that of its target, begins with a text.
    pub(crate) fn is_called(&self, text: &str) -> bool {
        self.name().starts_with(text) || self.target.starts_with(text)
    }

    /// The features that it needs, with the package.
    fn all_features(&self) -> Vec<String> {
        self.features.iter().map(|feature| format!("{}/{feature}", self.package)).collect()
    }

    /// The first paragraph of its documentation.
    pub(crate) fn summary(&self) -> Result<String, Box<dyn Error>> {
        let lines = std::fs::read_to_string(&self.source)?;
        let documentation = lines.lines().map_while(|line| line.strip_prefix("//!"));
        let paragraph = documentation.map(str::trim).take_while(|line| !line.is_empty());
        Ok(paragraph.collect::<Vec<_>>().join(" "))
    }

    /// Runs it to its end, and gives what it printed.
    pub(crate) fn run(
        &self,
        programs: &BTreeMap<PathBuf, PathBuf>,
    ) -> Result<String, Box<dyn Error>> {
        let program = programs.get(&self.source);
        let program = program.ok_or_else(|| format!("{} was not built", self.name()))?;
        let output = Command::new(program).arg("--bench").current_dir(&self.folder).output()?;
        succeeded(&self.name(), &output)?;
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

impl Results {
    pub(crate) fn read(text: &str) -> Results {
        let mut results = Results::default();
        for line in text.lines() {
            if let Ok(ratio) = line.parse() {
                results.ratios.push(ratio);
            } else if let Ok(growth) = line.parse() {
                results.growths.push(growth);
            } else if !line.trim().is_empty() {
                results.others.push(line.trim_end().to_owned());
            }
        }
        results
    }
}

/// The cargo that runs this program.
fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
}

fn succeeded(what: &str, output: &Output) -> Result<(), Box<dyn Error>> {
    if output.status.success() {
        return Ok(());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    Err(format!("{what} failed: {}\n{}", output.status, errors.trim_end()).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn benchmarks_are_found_with_their_features() {
        let text = r#"{"target_directory": "/t", "packages": [
            {"name": "b", "manifest_path": "/b/Cargo.toml", "targets": [
                {"name": "b", "kind": ["lib"], "src_path": "/b/lib.rs"},
                {"name": "z", "kind": ["bench"], "src_path": "/b/z.rs"}]},
            {"name": "a", "manifest_path": "/a/Cargo.toml", "targets": [
                {"name": "y", "kind": ["bench"], "src_path": "/a/y.rs", "required-features": ["f", "g"]}]}
        ]}"#;
        let workspace = Workspace::of(serde_json::from_str(text).expect("metadata"));
        let [y, z] = &workspace.benches[..] else { panic!("two benchmarks") };
        assert_eq!([y.name(), z.name()], ["a/y", "b/z"]);
        assert_eq!(
            ["y", "a/", "a/y", "", "b", "x"].map(|text| y.is_called(text)),
            [true, true, true, true, false, false]
        );
        assert_eq!(
            (y.all_features(), y.folder.as_path()),
            (vec!["a/f".into(), "a/g".into()], "/a".as_ref())
        );
    }

    #[test]
    fn kinds_of_lines_are_recognised() {
        let text = "sizes\n\nray: 1.50 x (target: at most 2 x, met)\n  3 ms\nray: grows as size^1 from 1 to 9\n";
        let results = Results::read(text);
        assert_eq!((results.ratios.len(), results.growths.len()), (1, 1));
        assert_eq!(results.others, ["sizes", "  3 ms"]);
        assert_eq!(Results::read("\n"), Results::default());
    }
}
