//! The panels for scores and for the comparison of two runs.

use bevy_egui::egui::{Grid, RichText, Ui};
use mapping_trial::score::Scores;
use mapping_trial::trial::TrialReport;

/// Draws the result of a trial: a summary of each robot, D, M, N and their components.
pub fn scores(ui: &mut Ui, report: &TrialReport) {
    ui.label(report.headline());
    for (i, robot) in report.robots.iter().enumerate() {
        ui.label(format!("robot {}: {}", i + 1, robot.summary()));
    }
    ui.separator();
    Grid::new("scores").num_columns(3).striped(true).spacing([16.0, 4.0]).show(ui, |ui| {
        for (i, row) in report.scores.rows().into_iter().enumerate() {
            // D, M and N come first.
            let value = RichText::new(row.value);
            ui.label(row.name);
            ui.label(if i < 3 { value.strong() } else { value });
            ui.weak(row.meaning);
            ui.end_row();
        }
    });
}

/// Draws runs on the same map side by side, each with its name.
pub fn comparison(ui: &mut Ui, runs: &[(&str, &Scores)]) {
    let columns: Vec<_> = runs.iter().map(|(_, scores)| scores.rows()).collect();
    let Some(first) = columns.first() else { return };
    let grid = Grid::new("comparison").num_columns(1 + runs.len()).striped(true);
    grid.spacing([16.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for (name, _) in runs {
            ui.strong(*name);
        }
        ui.end_row();
        for (i, row) in first.iter().enumerate() {
            ui.label(row.name);
            for column in &columns {
                ui.label(column.get(i).map_or("", |row| row.value.as_str()));
            }
            ui.end_row();
        }
        let mut fact = |name: &str, value: &dyn Fn(&Scores) -> String| {
            ui.label(name);
            for (_, scores) in runs {
                ui.label(value(scores));
            }
            ui.end_row();
        };
        fact("time", &|scores| format!("{:.0} s", scores.time));
        fact("distance", &|scores| format!("{:.0} m", scores.distance));
        fact("collisions", &|scores| scores.collisions.to_string());
    });
}
