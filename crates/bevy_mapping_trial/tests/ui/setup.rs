use crate::screen::{Screen, show_in};
use bevy_mapping_trial::ui::*;
use envgen::scenario::{DoorControl, ScenarioSpec};
use envgen::{Seed, WorldKind};
use mapping_trial::trial::TrialSettings;

/// The size of the panel of the example `teleop` at 1280 x 720: its width, and the height above the button
/// that starts a trial.
const PANEL: egui::Vec2 = egui::vec2(360.0, 640.0);

fn setup() -> SetupForm {
    let settings = TrialSettings { policy: None, ..Default::default() };
    let scenario = ScenarioForm::new(&ScenarioSpec::default());
    SetupForm { settings, scenario, training: false }
}

#[test]
fn the_common_settings_of_every_kind_fit_without_scrolling() {
    for &kind in WorldKind::ALL {
        let mut form = setup();
        let mut world = SpecForm::new(&SpecForm::initial(kind), Seed(3));
        let shown = show_in(PANEL, |ui| {
            ui.spacing_mut().item_spacing.y = 5.0;
            form.show(ui, &mut world);
        });
        let common = kind.settings().iter().chain(ScenarioSpec::SETTINGS);
        let common = common.filter(|setting| setting.group.is_none()).map(|setting| setting.name);
        let groups = ["World", "Robot and laser", "Trial", "Things that move", "Advanced"];
        let of_trial = ["a person", "scan_to_map", "lms200_mm", "skid", "robots", "time limit"];
        for text in common.chain(groups).chain(of_trial) {
            assert!(shown.has(text), "{kind} {text}");
        }
        assert_eq!(shown.cut(), Vec::<String>::new(), "{kind}");
    }
}

#[test]
fn all_other_settings_are_in_groups_that_open() {
    for &kind in WorldKind::ALL {
        let mut form = setup();
        let mut world = SpecForm::new(&kind.default_spec(), Seed(3));
        let screen = Screen::new(egui::vec2(360.0, 4000.0));
        let mut show = |ui: &mut egui::Ui| form.show(ui, &mut world);
        assert_eq!(screen.click("Advanced", &mut show), None);
        let settings = || kind.settings().iter().chain(ScenarioSpec::SETTINGS);
        let mut groups: Vec<&str> = settings().filter_map(|setting| setting.group).collect();
        groups.dedup();
        groups.sort_unstable();
        groups.dedup();
        for group in groups {
            screen.click_last(group, &mut show);
        }
        let shown = screen.show(|ui| drop(show(ui)));
        for setting in settings() {
            assert!(shown.has(setting.name), "{kind} {}", setting.name);
        }
        assert!(shown.has("wheel_calibration") && shown.has("turns"), "{kind}");
        // Long lists scroll inside their field.
        let mut clipped = shown.clipped();
        clipped.retain(|text| !text.contains(','));
        assert_eq!(clipped, Vec::<String>::new(), "{kind}");
    }
}

#[test]
fn what_a_setting_does_is_shown_under_the_pointer() {
    let mut form = setup();
    let mut world = SpecForm::new(&WorldKind::Indoor.default_spec(), Seed(3));
    let screen = Screen::new(PANEL);
    for (name, help) in [
        ("width", "a cell has the side `cell_size`\na whole number from 4 to 1024"),
        ("robots", TrialSettings::setting("robots").help),
        ("slam", TrialSettings::setting("slam").help),
        ("smoke", ScenarioSpec::setting("smoke").help),
    ] {
        let shown = screen.hover(name, |ui| drop(form.show(ui, &mut world)));
        assert!(shown.has(help), "{name}");
    }
}

#[test]
fn the_settings_are_checked() {
    let mut form = setup();
    assert_eq!(form.request(Seed(7)).map(|settings| settings.seed), Ok(Seed(7)));
    form.settings.time_limit = f64::NAN;
    assert!(form.request(Seed(7)).is_err_and(|error| error.field == "time_limit"));
}

#[test]
fn what_moves_is_edited_setting_by_setting() {
    let spec = ScenarioSpec { doors: 0.5, people: 3, ..Default::default() };
    let mut form = ScenarioForm::new(&spec);
    assert_eq!(form.request(), Ok(spec.clone()));
    form.set("door_control", "triggered");
    form.set("no such setting", "1");
    let door_control = DoorControl::Triggered;
    assert_eq!(form.request(), Ok(ScenarioSpec { door_control, ..spec }));
    form.set("smoke", "-1");
    assert_eq!(form.error_of("smoke"), Some("`smoke` must be a number from 0 to 100, got -1"));
    assert!(form.request().is_err_and(|error| error.field == "smoke"));
    assert_eq!(form.error_of("doors"), None);
}
