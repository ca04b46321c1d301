//! The scores as a table on the terminal.

use mapping_trial::names::Named;
use mapping_trial::trial::TrialReport;

/// Prints what came of a trial.
pub(crate) fn print(report: &TrialReport) {
    let scores = &report.scores;
    let name = |name: Option<&'static str>| name.unwrap_or("custom");
    let operator = report.settings.operator.as_ref().map_or("a person", |kind| name(kind.name()));
    println!(
        "{operator} with {} and {}, {:.0} m^2 to map\n",
        name(report.settings.slam.name()),
        name(report.settings.laser.name()),
        scores.free_area
    );
    for (i, robot) in report.robots.iter().enumerate() {
        println!(
            "robot {}: {} after {:.0} s, {:.0} m, {:.0} rad, {} hits, {} recoveries",
            i + 1,
            robot.end.map_or("under way", |end| end.text()),
            robot.time,
            robot.distance,
            robot.turning,
            robot.hits,
            robot.recoveries
        );
    }
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let metres = |way: f64| format!("{way:.2} m");
    let some = |way: Option<f64>| way.map_or("-".to_owned(), metres);
    let rows = [
        ("D  difficulty", format!("{:.2}", scores.difficulty), "0.6 M + 0.4 N, from 0 to 10"),
        ("M  of mapping", format!("{:.2}", scores.mapping), "walls, use, pose, coverage"),
        (
            "N  of getting around",
            format!("{:.2}", scores.navigation),
            "time, coverage, hits, turning",
        ),
        ("coverage", percent(scores.coverage), "of the reachable ground shown as free"),
        ("wall precision", percent(scores.precision_30), "within 0.30 m"),
        ("wall recall", percent(scores.recall_30), "within 0.30 m"),
        ("wall F1", percent(scores.f1_30), "within 0.30 m"),
        ("wall F1, strict", percent(scores.f1_15), "within 0.15 m"),
        ("wall distance", metres(scores.wall_distance), "mean, both ways, cut at 1 m"),
        ("ghosting", percent(scores.ghosting), "of the walls mapped twice"),
        ("navigability", percent(scores.navigability), "of 40 ways planned on the map arrive"),
        ("trajectory error", metres(scores.trajectory_error), "RMSE, not aligned"),
        ("relative error", some(scores.relative_error_near), "over 1 m"),
        ("relative error, far", some(scores.relative_error_far), "over 20 m"),
    ];
    println!();
    for (what, value, meaning) in rows {
        println!("{what:<22}{value:>9}  {meaning}");
    }
}
