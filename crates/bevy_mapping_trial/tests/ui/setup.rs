use crate::screen::show_in;
use bevy_mapping_trial::ui::*;
use envgen::Seed;
use mapping_trial::trial::TrialSettings;

#[test]
fn the_choices_are_shown_and_checked() {
    let settings = TrialSettings { policy: None, ..Default::default() };
    let mut form = SetupForm { settings, training: false };
    let shown = show_in(egui::vec2(300.0, 400.0), |ui| form.show(ui));
    for text in ["a person", "scan_to_map", "lms200_mm", "skid", "robots", "time limit"] {
        assert!(shown.has(text), "{text}");
    }
    assert_eq!(shown.clipped(), Vec::<String>::new());
    assert_eq!(form.request(Seed(7)).map(|settings| settings.seed), Ok(Seed(7)));
    form.settings.time_limit = f64::NAN;
    assert!(form.request(Seed(7)).is_err_and(|error| error.field == "time_limit"));
}
