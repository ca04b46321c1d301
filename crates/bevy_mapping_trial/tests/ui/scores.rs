use bevy_mapping_trial::ui::*;
use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
use mapping_trial::score::{Reference, Scores};
use mapping_trial::trial::{Trial, TrialSettings};

use crate::screen::show_in;

#[test]
fn scores_are_those_of_the_report() {
    let spec = HallwaySpec { segments: 3, ..Default::default() };
    let world = spec.generate(Seed(7)).expect("a hallway").to_world();
    let settings = TrialSettings { time_limit: 20.0, ..Default::default() };
    let mut trial = Trial::flat(&world, settings).expect("a trial");
    while trial.step() {}
    let truth = Reference::new(&world, &trial.settings().body).expect("a start");
    let report = trial.report(&world, &truth).expect("scores");
    let shown = show_in(egui::vec2(560.0, 600.0), |ui| scores(ui, &report));
    for row in report.scores.rows() {
        assert!(shown.has(row.name) && shown.has(&row.value), "{row:?}");
    }
    assert_eq!(shown.clipped(), Vec::<String>::new());

    let other = Scores { difficulty: 9.87, ..report.scores };
    let runs = [("you", &report.scores), ("nearest", &other)];
    let shown = show_in(egui::vec2(560.0, 600.0), |ui| comparison(ui, &runs));
    let time = format!("{:.0} s", report.scores.time);
    let own = format!("{:.2}", report.scores.difficulty);
    for text in ["you", "nearest", "9.87", own.as_str(), time.as_str()] {
        assert!(shown.has(text), "{text}");
    }
}
