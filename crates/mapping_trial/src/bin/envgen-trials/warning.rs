//! Warnings and errors on stderr.

use std::io::Write;

use mapping_trial::difficulty::Measurement;

/// The least mean coverage of trials without a warning.
const LEAST_COVERAGE: f64 = 0.5;

/// Prints a warning.
pub(crate) fn warn(text: &str) {
    print(&format!("warning: {text}"));
}

/// Prints a line. That this fails cannot be reported anywhere.
pub(crate) fn print(line: &str) {
    writeln!(std::io::stderr(), "{line}").ok();
}

/// Warns of trials that covered little: the scores of what was driven say nothing of the rest.
pub(crate) fn warn_of_coverage(measurement: &Measurement) {
    let shares = measurement.conditions.iter().map(|one| one.coverage);
    let coverage = shares.sum::<f64>() / measurement.conditions.len() as f64;
    if coverage < LEAST_COVERAGE {
        warn(&format!(
            "the trials covered only {:.0} % of the ground: their scores say little of the world",
            100.0 * coverage
        ));
    }
}
