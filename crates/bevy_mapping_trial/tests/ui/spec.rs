use crate::screen::{click, show_in};
use bevy_mapping_trial::ui::*;
use envgen::{Seed, WorldKind, WorldSpec};

fn form(kind: WorldKind) -> SpecForm {
    SpecForm::new(&kind.default_spec(), Seed(3))
}

#[test]
fn what_is_not_touched_comes_back_as_it_was() {
    for &kind in WorldKind::ALL {
        let (spec, seed) = form(kind).request().expect("defaults are allowed");
        assert_eq!((spec, seed), (kind.default_spec(), Seed(3)), "{kind}");
    }
}

#[test]
fn every_setting_of_every_kind_is_shown() {
    for &kind in WorldKind::ALL {
        let mut form = form(kind);
        let shown = show_in(egui::vec2(340.0, 4000.0), |ui| {
            assert_eq!(form.show(ui), None);
        });
        for setting in kind.settings() {
            assert!(shown.has(setting.name), "{kind} {}", setting.name);
        }
        // Long lists scroll in their field.
        let mut clipped = shown.clipped();
        clipped.retain(|text| !text.contains(','));
        assert_eq!(clipped, Vec::<String>::new(), "{kind}");
    }
}

#[test]
fn errors_stand_below_the_setting_they_name() {
    let mut form = form(WorldKind::Indoor);
    form.set("difficulty", "11");
    let text = "`difficulty` must be a number from 0 to 10, got 11";
    assert_eq!(form.error_of("difficulty"), Some(text));
    assert!(show_in(egui::vec2(340.0, 4000.0), |ui| drop(form.show(ui))).has(text));
    assert!(form.request().is_err());
    form.set("difficulty", "9.5");
    assert_eq!(form.error_of("difficulty"), None);
    assert!(form.request().is_ok());
    // Settings that forbid each other.
    form.set("doorway", "2.9");
    assert!(form.error_of("doorway").is_some_and(|error| error.contains("2.9")));
}

#[test]
fn other_kinds_keep_what_was_typed() {
    let mut form = form(WorldKind::Hallway);
    form.set("segments", "80");
    form.set_kind(WorldKind::Forest);
    form.set_kind(WorldKind::Hallway);
    let (spec, _) = form.request().expect("allowed");
    assert_eq!(spec.settings_json()["segments"], 80);
}

#[test]
fn the_button_asks_for_the_world() {
    let mut form = form(WorldKind::Forest);
    form.set("intensity", "0.2");
    let action = click(egui::vec2(340.0, 900.0), "Regenerate", |ui| form.show(ui));
    let Some(SpecAction::Regenerate { spec, seed }) = action else { panic!("{action:?}") };
    assert_eq!(spec.settings_json()["intensity"], 0.2);
    assert_eq!(seed, Seed(3));
}

#[test]
fn saved_specs_are_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("some.envgen.ron");
    let mut form = form(WorldKind::Landscape);
    form.set("total_edge", "1000");
    form.save(&path).expect("written");
    let text = std::fs::read_to_string(&path).expect("a file");
    assert_eq!(WorldSpec::from_ron(&text), form.request().map(|(spec, _)| spec));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    let error = form.save(&folder.path().join("no/such.ron")).expect_err("no folder");
    assert!(error.contains("no/such.ron"), "{error}");
}
