use crate::screen::show_in;
use bevy_mapping_trial::ui::*;
use envgen::Seed;
use envgen::scenario::{DoorControl, ScenarioSpec};
use mapping_trial::trial::TrialSettings;

#[test]
fn the_choices_are_shown_and_checked() {
    let settings = TrialSettings { policy: None, ..Default::default() };
    let scenario = ScenarioForm::new(&ScenarioSpec::default());
    let mut form = SetupForm { settings, scenario, training: false };
    let shown = show_in(egui::vec2(300.0, 400.0), |ui| form.show(ui));
    for text in [
        "a person",
        "scan_to_map",
        "lms200_mm",
        "skid",
        "robots",
        "time limit",
        "doors, people, smoke",
    ] {
        assert!(shown.has(text), "{text}");
    }
    assert_eq!(shown.clipped(), Vec::<String>::new());
    assert_eq!(form.request(Seed(7)).map(|settings| settings.seed), Ok(Seed(7)));
    form.settings.time_limit = f64::NAN;
    assert!(form.request(Seed(7)).is_err_and(|error| error.field == "time_limit"));
}

#[test]
fn what_moves_is_edited_setting_by_setting() {
    let spec = ScenarioSpec { doors: 0.5, people: 3, ..Default::default() };
    let mut form = ScenarioForm::new(&spec);
    assert_eq!(form.request(), Ok(spec.clone()));
    let shown = show_in(egui::vec2(330.0, 1200.0), |ui| form.show(ui));
    for setting in ScenarioSpec::SETTINGS {
        assert!(shown.has(setting.name), "{}", setting.name);
    }
    form.set("door_control", "triggered");
    form.set("no such setting", "1");
    let door_control = DoorControl::Triggered;
    assert_eq!(form.request(), Ok(ScenarioSpec { door_control, ..spec }));
    form.set("smoke", "-1");
    assert_eq!(form.error_of("smoke"), Some("`smoke` must be a number from 0 to 100, got -1"));
    assert!(form.request().is_err_and(|error| error.field == "smoke"));
    assert_eq!(form.error_of("doors"), None);
}
