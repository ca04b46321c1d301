//! The scores as a table on the terminal.

use std::fmt::Write;

use mapping_trial::trial::TrialReport;

/// Returns the results of a trial as lines.
pub(crate) fn table(report: &TrialReport) -> String {
    let mut text = format!("{}\n\n", report.headline());
    // Writing to a string does not fail.
    for (i, robot) in report.robots.iter().enumerate() {
        let _ = writeln!(text, "robot {}: {}", i + 1, robot.summary());
    }
    text.push('\n');
    for row in report.scores.rows() {
        let _ = writeln!(text, "{:<22}{:>9}  {}", row.name, row.value, row.meaning);
    }
    text
}
