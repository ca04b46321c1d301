//! Warnings and errors on stderr.

use std::io::Write;

/// Prints a warning.
pub(crate) fn warn(text: &str) {
    print(&format!("warning: {text}"));
}

/// Prints a line. That this fails cannot be reported anywhere.
pub(crate) fn print(line: &str) {
    writeln!(std::io::stderr(), "{line}").ok();
}
