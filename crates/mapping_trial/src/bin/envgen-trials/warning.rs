//! Warnings and errors on stderr.

use std::io::Write;
use std::path::Path;

use envgen::import::ros_map::unknown_cells_warning;
use mapping_trial::difficulty::Measurement;

/// Least mean coverage of trials for no warning.
const LEAST_COVERAGE: f64 = 0.5;

/// Prints a warning.
pub(crate) fn warn(text: &str) {
    print(&format!("warning: {text}"));
}

/// Prints a line. If this fails, there is nowhere to report it.
pub(crate) fn print(line: &str) {
    writeln!(std::io::stderr(), "{line}").ok();
}

/// Warns about a ROS map whose unknown cells seem to be free.
pub(crate) fn warn_of_map(path: &Path) {
    if let Some(text) = unknown_cells_warning(path) {
        warn(&format!("{}: {text}", path.display()));
    }
}

/// Warns about trials that covered little: their scores say nothing about the rest of the world.
pub(crate) fn warn_of_coverage(measurement: &Measurement) {
    let shares = measurement.conditions.iter().map(|one| one.coverage);
    let coverage = shares.sum::<f64>() / measurement.conditions.len() as f64;
    if coverage < LEAST_COVERAGE {
        warn(&format!(
            "the trials covered only {:.0} % of the ground: their scores say little of the world (--time-per-area gives more \
             time)",
            100.0 * coverage
        ));
    }
}
