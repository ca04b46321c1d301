//! The benchmarks of the workspace, and their runs.

use std::error::Error;
use std::process::{Command, Output};

use bench_ratio::{Growth, Ratio};
use serde::Deserialize;

/// A benchmark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Bench {
    package: String,
    target: String,
    features: Vec<String>,
}

/// What a benchmark printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Results {
    /// Its name.
    pub(crate) name: String,
    pub(crate) ratios: Vec<Ratio>,
    pub(crate) growths: Vec<Growth>,
    /// All other lines.
    pub(crate) others: Vec<String>,
    /// Whether it ended with an error, as some do where a bound is not met.
    pub(crate) failed: bool,
}

/// The part of `cargo metadata` that is read.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    targets: Vec<Target>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
    #[serde(default, rename = "required-features")]
    required_features: Vec<String>,
}

/// The benchmarks of all packages, in alphabetical order.
pub(crate) fn all() -> Result<Vec<Bench>, Box<dyn Error>> {
    let output = cargo().args(["metadata", "--no-deps", "--format-version", "1"]).output()?;
    succeeded("cargo metadata", &output)?;
    let metadata: Metadata = serde_json::from_slice(&output.stdout)?;
    Ok(of(metadata))
}

fn of(metadata: Metadata) -> Vec<Bench> {
    let mut benches = Vec::new();
    for Package { name: package, targets } in metadata.packages {
        for target in targets.into_iter().filter(|target| target.kind.iter().any(|k| k == "bench"))
        {
            let Target { name, required_features: features, .. } = target;
            benches.push(Bench { package: package.clone(), target: name, features });
        }
    }
    benches.sort_by_key(Bench::name);
    benches
}

impl Bench {
    /// Package and target, such as `envgen/forest`.
    pub(crate) fn name(&self) -> String {
        format!("{}/{}", self.package, self.target)
    }

    fn cargo_bench(&self) -> Command {
        let mut command = cargo();
        command.args(["bench", "--quiet", "-p", &self.package, "--bench", &self.target]);
        if !self.features.is_empty() {
            command.args(["--features", &self.features.join(",")]);
        }
        command
    }

    /// Builds it, so that nothing is built while it runs.
    pub(crate) fn build(&self) -> Result<(), Box<dyn Error>> {
        let output = self.cargo_bench().arg("--no-run").output()?;
        succeeded(&format!("building {}", self.name()), &output)
    }

    /// Runs it to its end.
    pub(crate) fn run(&self) -> Result<Results, Box<dyn Error>> {
        let output = self.cargo_bench().output()?;
        let results = Results::read(self.name(), &String::from_utf8_lossy(&output.stdout));
        // Some end with an error where a bound is not met; without results something else is wrong.
        if results.is_empty() {
            succeeded(&results.name, &output)?;
        }
        Ok(Results { failed: !output.status.success(), ..results })
    }
}

impl Results {
    fn read(name: String, text: &str) -> Results {
        let mut results = Results { name, ..Results::default() };
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

    fn is_empty(&self) -> bool {
        self.ratios.is_empty() && self.growths.is_empty() && self.others.is_empty()
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
        let text = r#"{"packages": [
            {"name": "b", "targets": [{"name": "b", "kind": ["lib"]}, {"name": "z", "kind": ["bench"]}]},
            {"name": "a", "targets": [{"name": "y", "kind": ["bench"], "required-features": ["f", "g"]}]}
        ]}"#;
        let benches = of(serde_json::from_str(text).expect("metadata"));
        let names: Vec<String> = benches.iter().map(Bench::name).collect();
        assert_eq!(names, ["a/y", "b/z"]);
        let command = benches[0].cargo_bench();
        let arguments: Vec<_> = command.get_args().filter_map(|part| part.to_str()).collect();
        assert_eq!(arguments[1..], ["--quiet", "-p", "a", "--bench", "y", "--features", "f,g"]);
    }

    #[test]
    fn lines_are_told_apart() {
        let text = "sizes\n\nray: 1.50 x (target: at most 2 x, met)\n  3 ms\nray: grows as size^1 from 1 to 9\n";
        let results = Results::read("a/y".to_owned(), text);
        assert_eq!((results.ratios.len(), results.growths.len()), (1, 1));
        assert_eq!(results.others, ["sizes", "  3 ms"]);
        assert!(!results.is_empty() && Results::read(String::new(), "\n").is_empty());
    }
}
