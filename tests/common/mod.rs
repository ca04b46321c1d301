//! Runs the examples as users do.

use std::path::Path;
use std::process::{Command, Output};

/// An example, by name.
pub(crate) struct Example(pub(crate) &'static str);

impl Example {
    /// Returns the command of an example, with its output folder. Cargo builds the examples beside the tests.
    pub(crate) fn command(&self, arguments: &[&str], out: &Path) -> Command {
        let mut path = std::env::current_exe().expect("this test");
        path.pop();
        path.pop();
        path.push("examples");
        path.push(format!("{}{}", self.0, std::env::consts::EXE_SUFFIX));
        assert!(path.exists(), "{} does not exist: build the examples first", path.display());
        let mut command = Command::new(path);
        command.args(arguments).arg("--out").arg(out);
        command
    }

    fn run(&self, arguments: &[&str], out: &Path) -> Output {
        self.command(arguments, out).output().expect("the example starts")
    }

    /// Returns the output of a run that must succeed.
    pub(crate) fn ok(&self, arguments: &[&str], out: &Path) -> String {
        let output = self.run(arguments, out);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        String::from_utf8(output.stdout).expect("text")
    }

    /// Returns the error output of a run that must fail without a report.
    pub(crate) fn error(&self, arguments: &[&str], out: &Path) -> String {
        let output = self.run(arguments, out);
        assert!(!output.status.success(), "{arguments:?} went well");
        assert!(output.stdout.is_empty() || !out.join("report.json").exists());
        String::from_utf8(output.stderr).expect("text")
    }
}
