//! The scores as a table on the terminal.

use mapping_trial::trial::TrialReport;

/// Prints what came of a trial.
pub(crate) fn print(report: &TrialReport) {
    println!("{}\n", report.headline());
    for (i, robot) in report.robots.iter().enumerate() {
        println!("robot {}: {}", i + 1, robot.summary());
    }
    println!();
    for row in report.scores.rows() {
        println!("{:<22}{:>9}  {}", row.name, row.value, row.meaning);
    }
}
